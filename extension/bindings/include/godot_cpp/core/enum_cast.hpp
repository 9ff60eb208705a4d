#pragma once

#include <cstdint>
#include <string_view>

namespace godot {

/// Flags of a bitfield enumeration.
template <typename T>
class BitField {
public:
	BitField(int64_t p_value) :
			value_(p_value) {}
	operator int64_t() const { return value_; }
	bool has_flag(T p_flag) const { return (value_ & p_flag) != 0; }
	void set_flag(T p_flag) { value_ |= p_flag; }

private:
	int64_t value_;
};

namespace internal {

/// The C++ name of an enumeration that the engine knows, and whether it is a bitfield; empty for all others.
template <typename T>
inline constexpr std::string_view enum_name{};
template <typename T>
inline constexpr bool is_bitfield = false;

} // namespace internal
} // namespace godot

/// Makes an enumeration known by its class, so that methods and properties can be of its type. At global scope.
#define VARIANT_ENUM_CAST(m_enum) \
	template <> \
	inline constexpr std::string_view godot::internal::enum_name<m_enum> = #m_enum;

#define VARIANT_BITFIELD_CAST(m_enum) \
	VARIANT_ENUM_CAST(m_enum) \
	template <> \
	inline constexpr bool godot::internal::is_bitfield<m_enum> = true;
