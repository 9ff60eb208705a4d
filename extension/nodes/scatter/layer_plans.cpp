#include "nodes/scatter/layer_plans.hpp"

#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Meters from a mesh's origin to the farthest corner of its box.
float reach_of(const Ref<Mesh> &mesh) {
	if (mesh.is_null()) {
		return 0.0F;
	}
	const AABB box = mesh->get_aabb();
	const Vector3 far_corner = box.position.abs().max((box.position + box.size).abs());
	return static_cast<float>(far_corner.length());
}

/// The reach of each mesh of a layer, at any distance.
std::vector<float> reaches_of(const LayerLook &look) {
	std::vector<float> reaches;
	for (const Ref<Mesh> &mesh : look.meshes) {
		reaches.push_back(reach_of(mesh));
	}
	for (std::size_t at = 0; at < look.lod_meshes.size(); ++at) {
		float &reach = reaches[at % reaches.size()];
		reach = std::max(reach, reach_of(look.lod_meshes[at]));
	}
	for (float &reach : reaches) {
		reach *= static_cast<float>(compensating_scale(look.detail, look.detail.thin_density));
	}
	return reaches;
}

/// Shows nothing, and asks for as few tiles as there can be.
StreamedLayer absent_layer() {
	LayerPlan plan;
	plan.settings = std::make_shared<const LayerSettings>();
	plan.wanted = false;
	return {std::make_shared<const LayerPlan>(std::move(plan)), {1e6, 0.0}, {}};
}

} // namespace

NamedLayer names_of(const ScatterLayer &layer) {
	NamedLayer named;
	named.name = layer.get_name().utf8().get_data();
	named.spacing = layer.spacing();
	named.proximity_layer = layer.proximity_layer();
	named.proximity_distance = layer.proximity_distance();
	named.proximity_curve = layer.proximity_table();
	return named;
}

void LayerPlans::clear() {
	places_.clear();
	streamed_.clear();
}

void LayerPlans::complain(std::size_t index, const Status &status) {
	const std::string owner = "layers[" + std::to_string(index) + "]: ScatterLayer";
	const String complaint = status.ok() ? String() : sentence(owner.c_str(), status);
	if (!complaint.is_empty() && !(complaint == places_[index].complaint)) {
		ERR_PRINT(complaint);
	}
	places_[index].complaint = complaint;
}

/// Takes over what a layer says, if it may be used.
Status LayerPlans::read(std::size_t index, const Ref<ScatterLayer> &p_layer, std::uint64_t seed) {
	next_[index] = index < streamed_.size() ? streamed_[index] : absent_layer();
	if (p_layer.is_null()) {
		places_[index] = {};
		next_[index] = absent_layer();
		return {};
	}
	if (const Status status = p_layer->check(); !status.ok()) {
		return status;
	}
	places_[index].source = names_of(*p_layer.ptr());
	places_[index].source->settings = p_layer->settings(seed, index);
	next_[index].range = p_layer->streaming();
	next_[index].look = {{p_layer->numbers(), p_layer->integers(), p_layer->get_material_override()},
			p_layer->mesh_list(), p_layer->lod_mesh_list(), p_layer->detail()};
	return {};
}

std::vector<LinkedLayer> LayerPlans::link() const {
	std::vector<const NamedLayer *> sources;
	for (const Place &place : places_) {
		sources.push_back(place.source ? &*place.source : nullptr);
	}
	std::vector<SharedLayer> before;
	for (const StreamedLayer &layer : streamed_) {
		before.push_back(layer.plan->wanted ? layer.plan->settings : nullptr);
	}
	return link_layers(sources, before, [this](const LayerSettings &layer, std::size_t place) {
		const double points = points_to_sample(layer, next_[place].range.tile_size);
		return points > ScatterLayer::max_tile_points ? Status{ErrorCode::too_many_points, "spacing", points}
													  : Status{};
	});
}

EditedArea LayerPlans::replace_plan(std::size_t index, const SharedLayer &settings, const ScatterGround &ground) {
	EditedArea area;
	if (settings == nullptr) {
		next_[index] = absent_layer();
		area.everywhere = index < streamed_.size() && streamed_[index].plan->wanted;
		return area;
	}
	LayerPlan plan;
	plan.settings = settings;
	plan.terrain = ground.terrain;
	plan.mesh_reach = reaches_of(next_[index].look);
	const LayerPlan *before = index < streamed_.size() ? streamed_[index].plan.get() : nullptr;
	if (before == nullptr || !before->wanted) {
		area.everywhere = true;
	} else {
		area = search_.find(*before->settings, *settings);
		area.everywhere = area.everywhere || before->mesh_reach != plan.mesh_reach ||
				streamed_[index].look.meshes != next_[index].look.meshes ||
				streamed_[index].look.lod_meshes != next_[index].look.lod_meshes;
		area.add(ground.changed, reach(*settings));
		if (area.empty() && before->settings == settings && before->terrain == plan.terrain) {
			return area;
		}
	}
	next_[index].plan = std::make_shared<const LayerPlan>(std::move(plan));
	next_[index].error_reported = false;
	return area;
}

std::vector<EditedArea> LayerPlans::update(
		const TypedArray<ScatterLayer> &p_layers, const ScatterGround &ground, RegionRegister &regions) {
	const auto count = static_cast<std::size_t>(p_layers.size());
	places_.resize(count);
	next_.resize(count);
	std::vector<Status> statuses;
	for (std::size_t index = 0; index < count; ++index) {
		const Ref<ScatterLayer> layer = p_layers[static_cast<int64_t>(index)];
		statuses.push_back(read(index, layer, ground.seed));
		if (std::optional<NamedLayer> &source = places_[index].source) {
			source->settings.rules.shapes = regions.set_for(p_layers, index);
		}
	}
	std::vector<EditedArea> areas;
	const std::vector<LinkedLayer> linked = link();
	for (std::size_t index = 0; index < count; ++index) {
		const bool refused = !linked[index].status.ok();
		if (refused && index < streamed_.size()) {
			next_[index] = streamed_[index];
		}
		complain(index, refused ? linked[index].status : statuses[index]);
		areas.push_back(replace_plan(index, linked[index].settings, ground));
	}
	search_ = {};
	streamed_ = std::move(next_);
	next_.clear(); // Holds on to no meshes and no ground.
	return areas;
}

} // namespace thicket
