#pragma once

#include <string_view>

namespace godot::internal {

/// The C++ name of an enumeration that the engine knows; empty for all others.
template <typename T>
inline constexpr std::string_view enum_name{};

} // namespace godot::internal

/// Makes an enumeration known by its class, so that methods and properties can be of its type. At global scope.
#define VARIANT_ENUM_CAST(m_enum) \
	template <> \
	inline constexpr std::string_view godot::internal::enum_name<m_enum> = #m_enum;
