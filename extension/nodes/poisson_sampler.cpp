#include "nodes/poisson_sampler.hpp"

#include "nodes/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>

#include <algorithm>
#include <cmath>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "PoissonSampler";
constexpr double rank_scale = 1.0 / 4294967296.0;

// A rank just below 2^32 must not round to 1.
float unit_rank(std::uint32_t rank) {
	return std::min(static_cast<float>(rank * rank_scale), std::nextafter(1.0F, 0.0F));
}

} // namespace

bool PoissonSampler::try_set(const PointSet &p_set) {
	const Status status = validate(p_set);
	report(class_name, status);
	if (status.ok()) {
		set_ = p_set;
	}
	return status.ok();
}

void PoissonSampler::set_seed(int64_t p_seed) { set_.seed = static_cast<std::uint64_t>(p_seed); }

int64_t PoissonSampler::get_seed() const { return static_cast<int64_t>(set_.seed); }

void PoissonSampler::set_radius(double p_radius) {
	PointSet candidate = set_;
	candidate.radius = p_radius;
	try_set(candidate);
}

double PoissonSampler::get_radius() const { return set_.radius; }

void PoissonSampler::set_levels(int64_t p_levels) {
	if (accept_number(class_name, "levels", static_cast<double>(p_levels), 1.0, max_levels)) {
		PointSet candidate = set_;
		candidate.levels = static_cast<std::uint32_t>(p_levels);
		try_set(candidate);
	}
}

int64_t PoissonSampler::get_levels() const { return set_.levels; }

bool PoissonSampler::fetch(const Rect &p_rect) {
	const Status status = sampler_.sample(set_, p_rect, points_);
	report(class_name, status);
	if (!status.ok()) {
		points_.clear();
	}
	return status.ok();
}

Dictionary PoissonSampler::ranks_and_ids() const {
	PackedFloat32Array ranks;
	PackedInt64Array ids;
	const auto count = static_cast<int64_t>(points_.size());
	ranks.resize(count);
	ids.resize(count);
	float *rank = ranks.ptrw();
	int64_t *id = ids.ptrw();
	for (const SamplePoint &point : points_) {
		*rank++ = unit_rank(point.rank);
		*id++ = static_cast<int64_t>(point.id);
	}
	Dictionary result;
	result["ranks"] = ranks;
	result["ids"] = ids;
	return result;
}

Dictionary PoissonSampler::sample(const Rect2 &p_rect) {
	const glm::dvec2 min{p_rect.position.x, p_rect.position.y};
	fetch({min, min + glm::dvec2{p_rect.size.x, p_rect.size.y}});
	Dictionary result = ranks_and_ids();
	PackedVector2Array positions;
	positions.resize(static_cast<int64_t>(points_.size()));
	Vector2 *position = positions.ptrw();
	for (const SamplePoint &point : points_) {
		*position++ = Vector2(static_cast<real_t>(point.position.x), static_cast<real_t>(point.position.y));
	}
	result["positions"] = positions;
	return result;
}

Dictionary PoissonSampler::sample_exact(double p_min_x, double p_min_y, double p_max_x, double p_max_y) {
	fetch({{p_min_x, p_min_y}, {p_max_x, p_max_y}});
	Dictionary result = ranks_and_ids();
	PackedFloat64Array x;
	PackedFloat64Array y;
	x.resize(static_cast<int64_t>(points_.size()));
	y.resize(static_cast<int64_t>(points_.size()));
	double *x_out = x.ptrw();
	double *y_out = y.ptrw();
	for (const SamplePoint &point : points_) {
		*x_out++ = point.position.x;
		*y_out++ = point.position.y;
	}
	result["x"] = x;
	result["y"] = y;
	return result;
}

void PoissonSampler::_bind_methods() {
	ClassDB::bind_method(D_METHOD("set_seed", "seed"), &PoissonSampler::set_seed);
	ClassDB::bind_method(D_METHOD("get_seed"), &PoissonSampler::get_seed);
	ClassDB::bind_method(D_METHOD("set_radius", "radius"), &PoissonSampler::set_radius);
	ClassDB::bind_method(D_METHOD("get_radius"), &PoissonSampler::get_radius);
	ClassDB::bind_method(D_METHOD("set_levels", "levels"), &PoissonSampler::set_levels);
	ClassDB::bind_method(D_METHOD("get_levels"), &PoissonSampler::get_levels);
	ClassDB::bind_method(D_METHOD("sample", "rect"), &PoissonSampler::sample);
	ClassDB::bind_method(D_METHOD("sample_exact", "min_x", "min_y", "max_x", "max_y"), &PoissonSampler::sample_exact);
	ADD_PROPERTY(PropertyInfo(Variant::INT, "seed"), "set_seed", "get_seed");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "radius", PROPERTY_HINT_RANGE, "0.001,1000,0.001,or_greater,suffix:m"),
			"set_radius", "get_radius");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "levels", PROPERTY_HINT_RANGE, "1,8,1"), "set_levels", "get_levels");
}

} // namespace thicket
