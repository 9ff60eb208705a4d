#pragma once

#include <godot_cpp/classes/wrapped.hpp>
#include <godot_cpp/core/class_hooks.hpp>
#include <godot_cpp/core/engine_call.hpp>
#include <godot_cpp/core/singleton.hpp>
#include <godot_cpp/variant/typed_array.hpp>

// Includes that every generated class header needs.
