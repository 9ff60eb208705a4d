// Prepares rules for evaluation.

#pragma once

#include "core/rules/rules.hpp"

#include <doctest/doctest.h>

#include <cstdint>

namespace thicket::test {

inline constexpr std::uint64_t seed = 42;

inline PreparedRules prepared(const Rules &rules) {
	PreparedRules result;
	REQUIRE(result.set(rules, seed).ok());
	return result;
}

} // namespace thicket::test
