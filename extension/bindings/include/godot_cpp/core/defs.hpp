#pragma once

#include <cstddef>
#include <cstdint>

#if defined(_WIN32)
#define GDE_EXPORT __declspec(dllexport)
#else
#define GDE_EXPORT __attribute__((visibility("default")))
#endif

namespace godot {

/// The engine's own real number. As for godot-cpp, REAL_T_IS_DOUBLE is defined for engines built with precision=double.
#ifdef REAL_T_IS_DOUBLE
using real_t = double;
#else
using real_t = float;
#endif

/// An object of the engine, known by its address only.
using GodotObject = void;

namespace internal {

/// The one of four figures that holds for this build: by the bits of a real number and of a pointer.
constexpr std::size_t in_build(
		std::size_t p_float_32, std::size_t p_float_64, std::size_t p_double_32, std::size_t p_double_64) {
	constexpr bool is_64 = sizeof(void *) == 8;
	return sizeof(real_t) == 4 ? (is_64 ? p_float_64 : p_float_32) : (is_64 ? p_double_64 : p_double_32);
}

} // namespace internal

} // namespace godot
