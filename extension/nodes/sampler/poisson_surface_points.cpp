#include "nodes/sampler/poisson_surface_points.hpp"

#include "nodes/common/bind_value.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/sampler/poisson_points.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

Ref<PoissonSurfacePoints> PoissonSurfacePoints::of(std::span<const SurfacePoint> points, bool is_mirrored) {
	const Ref<PoissonSurfacePoints> result(memnew(PoissonSurfacePoints));
	const double sign = is_mirrored ? 1.0 : -1.0;
	result->ranks_ =
			packed<PackedFloat32Array>(points, [](const SurfacePoint &point) { return unit_rank(point.rank); });
	result->positions_ =
			packed<PackedVector3Array>(points, [](const SurfacePoint &point) { return to_engine(point.position); });
	result->normals_ = packed<PackedVector3Array>(
			points, [sign](const SurfacePoint &point) { return to_engine(point.normal * sign); });
	result->faces_ = packed<PackedInt32Array>(
			points, [](const SurfacePoint &point) { return static_cast<int32_t>(point.triangle); });
	result->ids_ = packed<PackedInt64Array>(points, [](const SurfacePoint &point) { return script_id(point.id); });
	return result;
}

void PoissonSurfacePoints::_bind_methods() {
	using Self = PoissonSurfacePoints;
	bind_guarded<&Self::size>(D_METHOD("size"));
	bind_guarded<&Self::is_empty>(D_METHOD("is_empty"));
	bind_guarded<&Self::get_ids>(D_METHOD("get_ids"));
	bind_guarded<&Self::get_positions>(D_METHOD("get_positions"));
	bind_guarded<&Self::get_normals>(D_METHOD("get_normals"));
	bind_guarded<&Self::get_ranks>(D_METHOD("get_ranks"));
	bind_guarded<&Self::get_faces>(D_METHOD("get_faces"));
	bind_value(class_name, PropertyInfo(Variant::PACKED_INT64_ARRAY, "ids"), "get_ids");
	bind_value(class_name, PropertyInfo(Variant::PACKED_VECTOR3_ARRAY, "positions"), "get_positions");
	bind_value(class_name, PropertyInfo(Variant::PACKED_VECTOR3_ARRAY, "normals"), "get_normals");
	bind_value(class_name, PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "ranks"), "get_ranks");
	bind_value(class_name, PropertyInfo(Variant::PACKED_INT32_ARRAY, "faces"), "get_faces");
}

} // namespace thicket
