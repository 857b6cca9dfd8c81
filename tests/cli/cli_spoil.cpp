// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <limits>

#include "cli.hpp"
#include "resight/core/image.hpp"
#include "resight/io/images.hpp"
#include "resight/io/ply.hpp"
#include "resight/models/library_file.hpp"

namespace resight::cli_test {

Spoil remove(const char* path) {
  return [=](const fs::path& folder) { ASSERT_GT(fs::remove_all(folder / path), 0U); };
}
Spoil write(const char* path, const char* text) {
  return [=](const fs::path& folder) { write_text(folder / path, text); };
}
Spoil cut(const char* path, double share) {
  return [=](const fs::path& folder) {
    const auto size = static_cast<double>(fs::file_size(folder / path));
    fs::resize_file(folder / path, static_cast<std::uintmax_t>(share * size));
  };
}
Spoil pipe(const char* path) {
  return [=](const fs::path& folder) {
    fs::remove(folder / path);
    ASSERT_EQ(::mkfifo((folder / path).c_str(), 0600), 0);
  };
}
Spoil flip(const char* path, double share) {
  return [=](const fs::path& folder) {
    std::string bytes = read_text(folder / path);
    ASSERT_FALSE(bytes.empty());
    char& byte = bytes[static_cast<std::size_t>(share * static_cast<double>(bytes.size()))];
    byte = static_cast<char>(byte ^ 0x10);
    write_text(folder / path, bytes);
  };
}
Spoil replace(const char* path, const char* what, const char* by) {
  return [=](const fs::path& folder) {
    std::string text = read_text(folder / path);
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    write_text(folder / path, text.replace(at, std::string(what).size(), by));
  };
}
Spoil edit(const char* path, const std::function<void(Json&)>& change) {
  return [=](const fs::path& folder) {
    Json json = Json::parse(read_text(folder / path));
    change(json.at("1"));
    write_text(folder / path, json.dump());
  };
}
Spoil link(const char* path, const char* target) {
  return [=](const fs::path& folder) {
    fs::create_directories((folder / path).parent_path());
    fs::create_symlink(target, folder / path);
  };
}
Spoil both(const Spoil& first, const Spoil& second) {
  return [=](const fs::path& folder) {
    first(folder);
    second(folder);
  };
}
Spoil move(const char* from, const char* to) {
  return [=](const fs::path& folder) {
    fs::create_directories((folder / to).parent_path());
    fs::rename(folder / from, folder / to);
  };
}
Spoil copy(const char* from, const char* to) {
  return [=](const fs::path& folder) {
    fs::create_directories((folder / to).parent_path());
    fs::copy(folder / from, folder / to, fs::copy_options::recursive);
  };
}
Spoil remove_texts(const char* path) {
  return [=](const fs::path& folder) {
    std::vector<fs::path> texts;
    for (const auto& entry : fs::directory_iterator(folder / path))
      if (entry.path().extension() == ".txt") texts.push_back(entry.path());
    ASSERT_FALSE(texts.empty());
    for (const fs::path& text : texts) fs::remove(text);
  };
}
Spoil small_image(const char* path) {
  return
      [=](const fs::path& folder) { ASSERT_TRUE(write_color(folder / path, Image<Rgb8>(kWidth / 2, kHeight)).ok()); };
}
Spoil no_depth_at_all() {
  return [](const fs::path& folder) {
    const Image<float> nothing(kWidth, kHeight, std::numeric_limits<float>::quiet_NaN());
    for (int i = 0; i < kViews; ++i)
      ASSERT_TRUE(write_depth(folder / "views/depth" / ("00000" + std::to_string(i) + ".png"), nothing, 1e-4).ok());
  };
}
Spoil library(const std::function<ModelLibrary()>& make) {
  return [=](const fs::path& folder) { ASSERT_TRUE(save_library(make(), folder / "models.resight").ok()); };
}
Spoil mesh(const char* path, const std::function<TriangleMesh()>& make) {
  return [=](const fs::path& folder) { ASSERT_TRUE(write_ply(folder / path, make()).ok()); };
}

}  // namespace resight::cli_test
