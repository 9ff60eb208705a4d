#include "core/placement/host_collector.hpp"

#include "core/placement/mesh_choice.hpp"
#include "core/placement/mesh_rules.hpp"

#include <array>
#include <optional>

namespace thicket {

namespace {

/// Returns the instance at a point, without its mesh. The transform equals the one from
/// InstanceWriter, but is in doubles and in world space, so that it does not depend on the tile.
HostInstance instance_at(const LayerSettings &host, const PlacedPoints &points, std::uint32_t point) {
	const Placement &placement = host.placement;
	const ScaleSource &scale = host.instance_data.scale;
	const std::uint64_t id = points.ids[point];
	const glm::dvec2 position = points.positions[point];
	const Ground &ground = points.ground[point];
	const glm::dvec3 on_ground(position.x, ground.height, position.y);
	HostInstance instance{.id = id, .mesh = 0, .position = {}, .basis = glm::dmat3(1.0)};
	instance.position = host.planet.above(on_ground, placement.height_offset) +
			placement.offset_along_normal * glm::dvec3(ground.normal);
	std::array<float, transform_floats> floats{};
	const std::optional<double> number = scale.used()
			? std::optional(scale_number(scale, host.set.seed, id, points.fractions_of(point).scale))
			: std::nullopt;
	write_basis(placement, host.set.seed, id, ground.normal, floats, UpField(host.planet, instance.position), number,
			row_heading(host, id));
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			instance.basis[column][row] = floats[static_cast<std::size_t>(4 * row + column)];
		}
	}
	return instance;
}

} // namespace

HostCollector::HostCollector(const LayerSettings &layer, const Rect &rect) {
	const double distance = host_distance(layer, 0.0);
	around_ = expanded(rect, distance);
}

void HostCollector::add_part(const HostLayer &host, const HostInstance &instance) {
	const Surface *model = host.models->model(instance.mesh);
	if (model == nullptr) {
		return;
	}
	const PlacedModels::Part part{model, instance};
	const Box3 box = PlacedModels::bounds_of(part);
	if (!is_empty(box) && meet({{box.min.x, box.min.z}, {box.max.x, box.max.z}}, around_)) {
		parts_.push_back(part);
		bounds_ = with(bounds_, box);
	}
}

Status HostCollector::add(const HostLayer &host, const PlacedPoints &points) {
	const double host_reach = widest_reach_of(host);
	const Rect search_area = expanded(around_, host_reach);
	MeshChoice choice;
	choice.set(host.layer->mesh_weights);
	MeshRules rules;
	rules.set(*host.layer);
	MeshRules::Scratch scratch;
	for (const std::uint32_t point : points.accepted) {
		const std::uint64_t id = points.ids[point];
		if (!search_area.contains(points.positions[point]) || (host.changes != nullptr && host.changes->removed(id))) {
			continue;
		}
		HostInstance instance = instance_at(*host.layer, points, point);
		instance.mesh = choice.mesh_for(host.layer->set.seed, id);
		if (!rules.empty()) {
			const MeshPoint mesh_point{
					id, points.positions[point], points.ground[point], points.world_values_of(point)};
			std::uint8_t mesh = 0;
			if (const Status status = rules.choose({&mesh_point, 1}, {&mesh, 1}, scratch); !status.ok()) {
				return status;
			}
			instance.mesh = mesh;
		}
		add_part(host, instance);
	}
	std::vector<HostInstance> placed;
	if (host.changes != nullptr) {
		if (const Status status = host.changes->add_placed(search_area, placed); !status.ok()) {
			return status;
		}
	}
	for (const HostInstance &instance : placed) {
		add_part(host, instance);
	}
	return {};
}

Status HostCollector::surface(std::unique_ptr<const Surface> &r_surface) const {
	double triangles = 0.0;
	for (const PlacedModels::Part &part : parts_) {
		triangles += static_cast<double>(part.model->triangle_count());
	}
	if (triangles > static_cast<double>(Surface::max_triangles)) {
		return Status::out_of_range("triangles of surface_layers", triangles, at_most(Surface::max_triangles),
				"Lower tile_size, or use models with fewer triangles");
	}
	// The bounds extend beyond the collected models, because there may be more models outside.
	// Otherwise, the sampler would treat the border of the collected models as the end of the
	// surface.
	const double beyond = 1.0 + 0.1 * (around_.max.x - around_.min.x);
	const Box3 around{{around_.min.x - beyond, bounds_.min.y, around_.min.y - beyond},
			{around_.max.x + beyond, bounds_.max.y, around_.max.y + beyond}};
	r_surface = parts_.empty() ? nullptr : std::make_unique<const PlacedModels>(parts_, around);
	return {};
}

} // namespace thicket
