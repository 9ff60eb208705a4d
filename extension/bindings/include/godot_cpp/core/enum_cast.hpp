#pragma once

#include <string_view>

namespace godot::internal {

/// The C++ name of an enumeration that is registered with VARIANT_ENUM_CAST; empty for all others.
template <typename T>
inline constexpr std::string_view enum_name{};

} // namespace godot::internal

/// Registers an enumeration, so that methods and properties can use it as their type. Goes at global scope.
#define VARIANT_ENUM_CAST(m_enum) \
	template <> \
	inline constexpr std::string_view godot::internal::enum_name<m_enum> = #m_enum;
