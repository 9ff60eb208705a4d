#pragma once

#include <string_view>

namespace godot::internal {

/// The C++ name of an enumeration that is registered with VARIANT_ENUM_CAST. Empty for other types.
template <typename T>
inline constexpr std::string_view enum_name{};

} // namespace godot::internal

/// Registers an enumeration, so that it can be the type of arguments, results and properties. Must
/// be at global scope.
#define VARIANT_ENUM_CAST(m_enum) \
	template <> \
	inline constexpr std::string_view godot::internal::enum_name<m_enum> = #m_enum;
