// SPDX-License-Identifier: Apache-2.0
// Precompiled headers of all tests.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "precompiled.hpp"
