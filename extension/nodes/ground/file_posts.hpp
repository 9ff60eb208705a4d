#pragma once

#include "core/base/status.hpp"
#include "core/heightmap/posts.hpp"

#include <godot_cpp/variant/string.hpp>

#include <glm/vec2.hpp>

namespace thicket {

/// Reads the posts (height samples) of a PNG, EXR or raw file. `post_count` applies only to raw
/// files: columns and rows, or (0, 0) for a square. Errors name `heightmap_path` or `post_count`.
/// Any thread may call this function.
Status read_file_posts(const godot::String &p_path, glm::ivec2 post_count, Posts &r_posts);

} // namespace thicket
