#include "core/explain/position_explainer.hpp"

#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/sampling/dart.hpp"
#include "core/surface/surface_sampler.hpp"
#include "core/terrain/nearest_position.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

Status evaluate_rules(const DensityProbe &probe, std::size_t index, RuleResult &r_result) {
	r_result.ground = probe.ground_at(index);
	const Status status = probe.factors_at(index, r_result.factors);
	r_result.density = product_of(r_result.factors);
	return status;
}

} // namespace

Status PositionExplainer::find(
		const LayerSettings &layer, const glm::dvec3 &position, const Surface *surface, const Surface *models) {
	for (const double coordinate : {position.x, position.z}) {
		if (!std::isfinite(coordinate)) {
			return {ErrorCode::not_finite, "position", coordinate};
		}
	}
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	if (const Status status = guarded("meshes", 1.0, [&] { mesh_rules_.set(layer); }); !status.ok()) {
		return status;
	}
	if (!layer.set.on_surface) {
		return find_on_top(layer, {position.x, position.z}, surface);
	}
	if (!std::isfinite(position.y)) {
		return {ErrorCode::not_finite, "position", position.y};
	}
	const Surface *host_surface = layer.hosted ? models : surface;
	if (host_surface == nullptr) {
		return layer.hosted ? Status::missing("model of surface_layers", "Explain a position on a model")
							: Status::missing("surface of the ground", "Use a ground of meshes");
	}
	return guarded("position", position.x, [&] { return find_on_surface(layer, position, *host_surface, surface); });
}

Status PositionExplainer::find_on_top(const LayerSettings &layer, glm::dvec2 position, const Surface *surface) {
	const Status status = points_.find(layer, {&position, 1});
	position_ = position;
	surface_ = surface;
	if (!status.ok() || points_.is_complete()) {
		return status.ok() ? probe_on_top(layer) : status;
	}
	return guarded("position", position.x, [&] {
		layer_ = layer;
		return Status();
	});
}

/// Prepares the probe, once the point is known.
Status PositionExplainer::probe_on_top(const LayerSettings &layer) {
	point_ = points_.points().front();
	has_point_ = std::isfinite(point_.position.x);
	if (!has_point_) {
		// No other point lies in the position's cell, because it would be nearer than the radius.
		const double cell = lattice_unit(layer.set) * cell_size;
		point_.position = position_;
		point_.id = pack({layer.set.layer, glm::ivec2(glm::floor(position_ / cell))});
	}
	distance_ = glm::distance(position_, point_.position);
	const std::array<glm::dvec2, 2> positions{position_, point_.position};
	return probe_.find(layer, positions, true, surface_);
}

Status PositionExplainer::find_further(std::span<const Ground> ground) {
	if (points_.is_complete()) {
		return probe_.find_further(ground);
	}
	const Status status = points_.find_further(ground);
	return status.ok() && points_.is_complete() ? probe_on_top(layer_) : status;
}

/// Prepares the explanation of a position on `host_surface`, the surface on which the layer grows.
/// `ground_surface` is the surface of the ground, on which other layers may grow; null if there is
/// none.
Status PositionExplainer::find_on_surface(const LayerSettings &layer, const glm::dvec3 &position,
		const Surface &host_surface, const Surface *ground_surface) {
	points_.clear();
	has_point_ = true;
	const double radius = layer.set.radius;
	const SurfacePosition hit = nearest_position(host_surface, position, radius);
	if (!(glm::distance(hit.position, position) <= radius)) {
		return Status::missing(layer.hosted ? "model of surface_layers" : "surface of the ground",
				"Explain a position that is nearer than the radius to a surface");
	}
	SurfaceSampler sampler(layer.hosted ? host_margins : SampleMargins());
	std::vector<SurfacePoint> points;
	const Box3 search_box{hit.position - 1.5 * radius, hit.position + 1.5 * radius};
	Status status = sampler.sample(layer.set, host_surface, search_box, points);
	if (status.ok() && points.empty()) {
		// The slope limits may exclude all faces here. A point on an excluded face is then
		// explained, so that the factor of its slope shows the reason.
		PointSet unlimited_set = layer.set;
		unlimited_set.faces = SurfaceFaces::all;
		status = sampler.sample(unlimited_set, host_surface, search_box, points);
	}
	if (!status.ok()) {
		return status;
	}
	const auto nearest = std::ranges::min_element(points, {}, [&](const SurfacePoint &point) {
		return std::pair(glm::distance(point.position, hit.position), point.id);
	});
	if (nearest == points.end()) {
		return Status::missing("points of the set", "Explain a position on a larger surface");
	}
	const glm::dvec2 point_position(nearest->position.x, nearest->position.z);
	point_ = {point_position, nearest->id, nearest->rank, nearest->level};
	distance_ = glm::distance(nearest->position, hit.position);
	const std::array<glm::dvec2, 2> positions{glm::dvec2(hit.position.x, hit.position.z), point_position};
	const std::array<Ground, 2> ground{Ground{static_cast<float>(hit.position.y), glm::vec3(hit.normal)},
			Ground{static_cast<float>(nearest->position.y), glm::vec3(nearest->normal)}};
	return probe_.find(layer, positions, true, ground_surface, ground, &host_surface);
}

Status PositionExplainer::explain(std::span<const Ground> ground, PositionExplanation &r_explanation) {
	Status status = probe_.evaluate(ground);
	if (status.ok()) {
		status = evaluate_rules(probe_, 0, r_explanation.at_position);
	}
	if (status.ok()) {
		status = evaluate_rules(probe_, 1, r_explanation.at_point);
	}
	if (status.ok()) {
		r_explanation.point = point_;
		r_explanation.distance = distance_;
		r_explanation.has_point = has_point_;
		status = guarded("meshes", 1.0, [&] { return explain_mesh(r_explanation); });
	}
	return status;
}

/// Explains the choice of the mesh at the point, for which all rules are already evaluated.
Status PositionExplainer::explain_mesh(PositionExplanation &r_explanation) const {
	std::vector<float> world_values;
	Status status = probe_.world_values_at(1, world_values);
	const MeshPoint point{point_.id, point_.position, r_explanation.at_point.ground, world_values};
	std::uint8_t mesh = 0;
	MeshRules::Scratch scratch;
	if (status.ok()) {
		status = mesh_rules_.choose({&point, 1}, {&mesh, 1}, scratch);
	}
	if (status.ok()) {
		status = mesh_rules_.find_shares(point, r_explanation.meshes);
		r_explanation.mesh = mesh;
	}
	return status;
}

} // namespace thicket
