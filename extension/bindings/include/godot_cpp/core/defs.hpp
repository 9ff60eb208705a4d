#pragma once

#include <cstddef>
#include <cstdint>

#if defined(_WIN32)
#define GDE_EXPORT __declspec(dllexport)
#else
#define GDE_EXPORT __attribute__((visibility("default")))
#endif

namespace godot {

/// The engine's own real number in the configuration that this stand-in is made for.
using real_t = float;

/// An object of the engine, known by its address only.
using GodotObject = void;

} // namespace godot
