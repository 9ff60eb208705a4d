#pragma once

#include "core/surface/surface_sampler.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <cstdint>
#include <span>

namespace thicket {

/// The points that a PoissonSampler has generated on a surface. Immutable, so any thread may read
/// them.
class PoissonSurfacePoints : public godot::RefCounted {
	GDCLASS(PoissonSurfacePoints, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	static constexpr const char *class_name = "PoissonSurfacePoints";

	/// Creates the result of a rejected call: no points.
	static godot::Ref<PoissonSurfacePoints> make_empty() { return memnew(PoissonSurfacePoints); }

	/// Copies points. Their normals are on the side that the engine treats as the front, from which
	/// the corners run clockwise. Set `is_mirrored` if a transform has reversed the order of the
	/// corners. Throws std::bad_alloc if memory runs out.
	static godot::Ref<PoissonSurfacePoints> of(std::span<const SurfacePoint> points, bool is_mirrored);

	int64_t size() const { return ids_.size(); }
	bool is_empty() const { return size() == 0; }
	godot::PackedInt64Array get_ids() const { return ids_; }
	godot::PackedFloat32Array get_ranks() const { return ranks_; }
	godot::PackedVector3Array get_positions() const { return positions_; }
	godot::PackedVector3Array get_normals() const { return normals_; }
	godot::PackedInt32Array get_faces() const { return faces_; }

protected:
	static void _bind_methods();

private:
	godot::PackedInt64Array ids_;
	godot::PackedFloat32Array ranks_;
	godot::PackedVector3Array positions_;
	godot::PackedVector3Array normals_;
	godot::PackedInt32Array faces_;
};

} // namespace thicket
