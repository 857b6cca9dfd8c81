// SPDX-License-Identifier: Apache-2.0
#pragma once
// Each header needs those before it.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on
