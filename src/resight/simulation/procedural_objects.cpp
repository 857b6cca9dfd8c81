// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/procedural_objects.hpp"

#include <algorithm>
#include <iterator>

#include "resight/core/parallel.hpp"
#include "resight/simulation/internal/object_makers.hpp"

namespace resight {
namespace {

const std::vector<ObjectMaker>& all_makers() {
  static const std::vector<ObjectMaker> makers = [] {
    std::vector<ObjectMaker> all = package_makers();
    std::ranges::move(round_makers(), std::back_inserter(all));
    std::ranges::move(toy_makers(), std::back_inserter(all));
    return all;
  }();
  return makers;
}

}  // namespace

const std::vector<std::string>& procedural_object_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const ObjectMaker& maker : all_makers()) all.push_back(maker.name);
    return all;
  }();
  return names;
}

Result<ProceduralObject> make_procedural_object(std::string_view name) {
  for (const ObjectMaker& maker : all_makers())
    if (maker.name == name) return maker.make();
  std::string known;
  for (const std::string& n : procedural_object_names()) known += (known.empty() ? "" : ", ") + n;
  return Error{"no procedural object '" + std::string(name) + "' (known: " + known + ")"};
}

std::vector<ProceduralObject> procedural_objects(int num_threads) {
  const std::vector<ObjectMaker>& makers = all_makers();
  std::vector<ProceduralObject> objects(makers.size());
  parallel_for(makers.size(), num_threads, [&](std::size_t i) { objects[i] = makers[i].make(); });
  return objects;
}

}  // namespace resight
