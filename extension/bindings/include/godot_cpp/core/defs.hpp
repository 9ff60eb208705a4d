#pragma once

#include <cstddef>
#include <cstdint>

#if defined(_WIN32)
#define GDE_EXPORT __declspec(dllexport)
#else
#define GDE_EXPORT __attribute__((visibility("default")))
#endif

namespace godot {

/// The engine's real type. As in godot-cpp, REAL_T_IS_DOUBLE is defined for engines that were built
/// with precision=double.
#ifdef REAL_T_IS_DOUBLE
using real_t = double;
#else
using real_t = float;
#endif

/// An engine object. Only its address is used.
using GodotObject = void;

namespace internal {

/// Returns the argument for the current build, which depends on the sizes of a real and of a
/// pointer.
constexpr std::size_t in_build(
		std::size_t p_float_32, std::size_t p_float_64, std::size_t p_double_32, std::size_t p_double_64) {
	constexpr bool is_64 = sizeof(void *) == 8;
	return sizeof(real_t) == 4 ? (is_64 ? p_float_64 : p_float_32) : (is_64 ? p_double_64 : p_double_32);
}

} // namespace internal

} // namespace godot
