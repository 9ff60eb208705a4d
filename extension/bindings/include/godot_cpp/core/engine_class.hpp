#pragma once

#include <godot_cpp/classes/wrapped.hpp>
#include <godot_cpp/core/class_hooks.hpp>
#include <godot_cpp/core/engine_call.hpp>
#include <godot_cpp/core/singleton.hpp>
#include <godot_cpp/variant/typed_array.hpp>

// This header contains the includes that all generated class headers need.
