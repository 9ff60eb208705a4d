#pragma once

#include <godot_cpp/core/class_hooks.hpp>

/// A new object of a class of ours that is registered, with its defaults.
#define memnew(m_class) (::godot::internal::Class<m_class>::make())
