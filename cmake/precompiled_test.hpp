// SPDX-License-Identifier: Apache-2.0
// Precompiled for all tests.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "precompiled.hpp"
