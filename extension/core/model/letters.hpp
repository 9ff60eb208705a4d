#pragma once

#include <cstddef>
#include <string_view>

namespace thicket {

// The functions below classify the characters of model names: ASCII only, independent of the
// locale.

constexpr bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
constexpr bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
constexpr bool is_letter(char c) { return is_upper(c) || is_lower(c); }
constexpr char lower(char c) { return is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c; }

/// Returns true if a word begins at index `at`: after a character that is not a letter, or at a
/// capital after a lowercase letter ("TrunkLOD1").
constexpr bool begins_word(std::string_view name, std::size_t at) {
	const char before = at > 0 ? name[at - 1] : '_';
	return !is_letter(before) || (is_lower(before) && is_upper(name[at]));
}

} // namespace thicket
