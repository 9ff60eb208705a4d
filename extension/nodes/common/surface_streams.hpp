#pragma once

#include <cstdint>

namespace thicket {

/// The indices of vertex streams in the result of Mesh.surface_get_arrays (Mesh.ArrayType).
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

/// The flags of Mesh.ArrayFormat that affect how positions are stored.
struct SurfaceFormat {
	static constexpr std::uint64_t flat = 1U << 25U;        ///< ARRAY_FLAG_USE_2D_VERTICES.
	static constexpr std::uint64_t no_vertices = 1U << 28U; ///< ARRAY_FLAG_USES_EMPTY_VERTEX_ARRAY.
	static constexpr std::uint64_t quantized = 1U << 29U;   ///< ARRAY_FLAG_COMPRESS_ATTRIBUTES.
};

/// Values of Mesh.PrimitiveType.
struct SurfacePrimitive {
	static constexpr std::int64_t line_strip = 2;
	static constexpr std::int64_t triangles = 3;
	static constexpr std::int64_t triangle_strip = 4;
};

} // namespace thicket
