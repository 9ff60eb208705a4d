#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace godot {

/// A string in an 8-bit encoding.
class CharString {
public:
	const char *get_data() const { return text_.c_str(); }
	int64_t length() const { return static_cast<int64_t>(text_.size()); }

private:
	friend class String;

	explicit CharString(std::string p_text) : text_(std::move(p_text)) {}

	std::string text_;
};

} // namespace godot
