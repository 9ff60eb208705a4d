#pragma once

#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/rect2.hpp>

#include <vector>

namespace thicket {

/// The sampler itself, for scripts: windows onto one infinite Poisson-disk set. Holds a workspace, so one object
/// serves one thread at a time; objects on different threads are independent and agree bit for bit.
class PoissonSampler : public godot::RefCounted {
	GDCLASS(PoissonSampler, godot::RefCounted)

public:
	/// Any 64-bit number; other seeds name other sets.
	void set_seed(int64_t p_seed);
	int64_t get_seed() const;

	/// Metres between any two points, at least; [min_radius, max_radius]. Anything else prints an error and is ignored.
	void set_radius(double p_radius);
	double get_radius() const;

	/// Levels of the progressive order, 1 to max_levels. Anything else prints an error and is ignored.
	void set_levels(int64_t p_levels);
	int64_t get_levels() const;

	/// The points of the set in a half-open rectangle in metres: positions (PackedVector2Array, single precision),
	/// ranks (PackedFloat32Array, 0 to 1), ids (PackedInt64Array). A refused rectangle prints an error and gives
	/// empty arrays.
	godot::Dictionary sample(const godot::Rect2 &p_rect);

	/// As `sample`, with the rectangle as [min, max) and positions as two PackedFloat64Arrays `x` and `y`, exact at any
	/// distance from the origin.
	godot::Dictionary sample_exact(double p_min_x, double p_min_y, double p_max_x, double p_max_y);

protected:
	static void _bind_methods();

private:
	bool fetch(const Rect &p_rect);
	godot::Dictionary ranks_and_ids() const;
	bool try_set(const PointSet &p_set);

	PointSet set_;
	TileSampler sampler_;
	std::vector<SamplePoint> points_; ///< Of the last call; kept for its memory.
};

} // namespace thicket
