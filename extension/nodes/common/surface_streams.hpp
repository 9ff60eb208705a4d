#pragma once

#include <cstdint>

namespace thicket {

/// Where each stream of vertices is in what Mesh.surface_get_arrays returns (Mesh.ArrayType).
struct SurfaceStream {
	static constexpr std::int64_t positions = 0;
	static constexpr std::int64_t normals = 1;
	static constexpr std::int64_t tangents = 2;
	static constexpr std::int64_t colors = 3;
	static constexpr std::int64_t uvs = 4;
	static constexpr std::int64_t custom3 = 9;
	static constexpr std::int64_t bones = 10;
	static constexpr std::int64_t weights = 11;
	static constexpr std::int64_t indices = 12;
};

/// Mesh.PrimitiveType.
struct SurfacePrimitive {
	static constexpr std::int64_t line_strip = 2;
	static constexpr std::int64_t triangles = 3;
	static constexpr std::int64_t triangle_strip = 4;
};

} // namespace thicket
