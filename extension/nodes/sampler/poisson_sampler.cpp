#include "nodes/sampler/poisson_sampler.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/threads.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

using namespace godot;

namespace thicket {

PoissonSampler::CallScope::CallScope(PoissonSampler *p_sampler, const char *p_method) :
		sampler_(p_sampler), is_granted_(!p_sampler->is_busy_.exchange(true)) {
	if (is_granted_) {
		p_sampler->is_cancelled_ = false;
	} else {
		ERR_PRINT(vformat(
				"%s.%s() was called during another call to the same object. Use a separate object for each call.",
				class_name, p_method));
	}
}

PoissonSampler::CallScope::~CallScope() {
	if (is_granted_) {
		sampler_->is_busy_ = false;
	}
}

void PoissonSampler::cancel() { is_cancelled_ = true; }

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

void PoissonSampler::set_progressive_levels(int64_t p_levels) {
	if (accept_number(class_name, "progressive_levels", static_cast<double>(p_levels), 1.0, max_levels)) {
		PointSet candidate = set_;
		candidate.levels = static_cast<std::uint32_t>(p_levels);
		try_set(candidate);
	}
}

int64_t PoissonSampler::get_progressive_levels() const { return set_.levels; }

void PoissonSampler::set_method(Method p_method) {
	if (accept_number(class_name, "method", static_cast<double>(p_method), METHOD_TILES, METHOD_WAVEFRONT)) {
		method_ = p_method;
	}
}

PoissonSampler::Method PoissonSampler::get_method() const { return method_; }

void PoissonSampler::set_toroidal(bool p_toroidal) { toroidal_ = p_toroidal; }

bool PoissonSampler::is_toroidal() const { return toroidal_; }

void PoissonSampler::set_double_precision(bool p_double_precision) { double_precision_ = p_double_precision; }

bool PoissonSampler::is_double_precision() const { return double_precision_; }

void PoissonSampler::set_cell_size(double p_cell_size) {
	if (accept_number(class_name, "cell_size", p_cell_size, 0.0, max_cell_size)) {
		cell_size_ = p_cell_size;
	}
}

double PoissonSampler::get_cell_size() const { return cell_size_; }

std::span<const SamplePoint> PoissonSampler::fetch(const CallScope &p_scope, const Rect &p_rect) {
	if (!p_scope.is_granted()) {
		return {};
	}
	EngineThreads threads;
	const Status status = sampler_.sample(set_, p_rect, points_, {.cancel = &is_cancelled_, .report = {}}, &threads);
	report(class_name, status);
	return status.ok() ? std::span<const SamplePoint>(points_) : std::span<const SamplePoint>();
}

Ref<PoissonPoints> PoissonSampler::sample(const Rect2 &p_rect) {
	const CallScope scope(this, "sample");
	return PoissonPoints::of(fetch(scope, to_core(p_rect)), false);
}

Ref<PoissonPoints> PoissonSampler::sample_exact(double p_min_x, double p_min_y, double p_max_x, double p_max_y) {
	const CallScope scope(this, "sample_exact");
	return PoissonPoints::of(fetch(scope, {{p_min_x, p_min_y}, {p_max_x, p_max_y}}), true);
}

void PoissonSampler::_bind_methods() {
	bind_guarded<&PoissonSampler::set_seed>(D_METHOD("set_seed", "seed"));
	bind_guarded<&PoissonSampler::get_seed>(D_METHOD("get_seed"));
	bind_guarded<&PoissonSampler::set_radius>(D_METHOD("set_radius", "radius"));
	bind_guarded<&PoissonSampler::get_radius>(D_METHOD("get_radius"));
	bind_guarded<&PoissonSampler::set_progressive_levels>(D_METHOD("set_progressive_levels", "progressive_levels"));
	bind_guarded<&PoissonSampler::get_progressive_levels>(D_METHOD("get_progressive_levels"));
	bind_guarded<&PoissonSampler::sample>(D_METHOD("sample", "rect"));
	bind_guarded<&PoissonSampler::sample_exact>(D_METHOD("sample_exact", "min_x", "min_y", "max_x", "max_y"));
	bind_guarded<&PoissonSampler::set_method>(D_METHOD("set_method", "method"));
	bind_guarded<&PoissonSampler::get_method>(D_METHOD("get_method"));
	bind_guarded<&PoissonSampler::set_toroidal>(D_METHOD("set_toroidal", "toroidal"));
	bind_guarded<&PoissonSampler::is_toroidal>(D_METHOD("is_toroidal"));
	bind_guarded<&PoissonSampler::set_double_precision>(D_METHOD("set_double_precision", "double_precision"));
	bind_guarded<&PoissonSampler::is_double_precision>(D_METHOD("is_double_precision"));
	bind_guarded<&PoissonSampler::set_cell_size>(D_METHOD("set_cell_size", "cell_size"));
	bind_guarded<&PoissonSampler::get_cell_size>(D_METHOD("get_cell_size"));
	bind_guarded<&PoissonSampler::sample_domain>(D_METHOD("sample_domain", "rect", "progress"), DEFVAL(Callable()));
	bind_guarded<&PoissonSampler::sample_domain_exact>(
			D_METHOD("sample_domain_exact", "min_x", "min_y", "max_x", "max_y", "progress"), DEFVAL(Callable()));
	bind_guarded<&PoissonSampler::sample_surface>(
			D_METHOD("sample_surface", "mesh", "transform", "window"), DEFVAL(Transform3D()), DEFVAL(AABB()));
	bind_guarded<&PoissonSampler::sample_faces>(D_METHOD("sample_faces", "faces", "window"), DEFVAL(AABB()));
	bind_guarded<&PoissonSampler::cancel>(ThreadUse::any, D_METHOD("cancel"));
	bind_guarded<&PoissonSampler::get_stats>(D_METHOD("get_stats"));
	ADD_PROPERTY(PropertyInfo(Variant::INT, "seed"), "set_seed", "get_seed");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "radius", PROPERTY_HINT_RANGE, "0.001,1000,0.001,or_greater,suffix:m"),
			"set_radius", "get_radius");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "progressive_levels", PROPERTY_HINT_RANGE, "1,8,1"),
			"set_progressive_levels", "get_progressive_levels");
	ADD_GROUP("Whole domains", "");
	ADD_PROPERTY(
			PropertyInfo(Variant::INT, "method", PROPERTY_HINT_ENUM, "Tiles,Naive,Hierarchical,Accumulator,Wavefront"),
			"set_method", "get_method");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "toroidal"), "set_toroidal", "is_toroidal");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "double_precision"), "set_double_precision", "is_double_precision");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "cell_size", PROPERTY_HINT_RANGE, "0,1000,0.1,suffix:r"), "set_cell_size",
			"get_cell_size");
	BIND_ENUM_CONSTANT(METHOD_TILES);
	BIND_ENUM_CONSTANT(METHOD_NAIVE);
	BIND_ENUM_CONSTANT(METHOD_HIERARCHICAL);
	BIND_ENUM_CONSTANT(METHOD_ACCUMULATOR);
	BIND_ENUM_CONSTANT(METHOD_WAVEFRONT);
}

} // namespace thicket
