#include "core/placement/mesh_rules.hpp"

#include "core/base/guard.hpp"
#include "core/rules/instance_random.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace thicket {

void MeshRules::set(const LayerSettings &layer) {
	ruled_.clear();
	plain_.set(layer.mesh_weights);
	weights_.assign(layer.mesh_weights.begin(), layer.mesh_weights.end());
	seed_ = layer.set.seed;
	on_surface_ = layer.set.on_surface;
	if (plain_.size() == 1) {
		// There is no choice.
		return;
	}
	const GroundSides sides = on_surface_ ? GroundSides::all : GroundSides::top;
	for (std::size_t mesh = 0; mesh < layer.mesh_rules.size(); ++mesh) {
		if (layer.mesh_rules[mesh].has_value() && weights_[mesh] > 0.0) {
			Rules rules = *layer.mesh_rules[mesh];
			rules.water = layer.rules.water;
			RuledMesh &ruled_mesh = ruled_.emplace_back();
			ruled_mesh.mesh = mesh;
			// The rules are valid, so the call can fail only for lack of memory.
			throw_if_out_of_memory(ruled_mesh.rules.set(rules, seed_, sides, layer.planet));
			for (std::size_t input = 0; rules.expression != nullptr && input < rules.expression->world_inputs().size();
					++input) {
				ruled_mesh.sources.push_back(source_of(layer.world_sources, rules.expression->world_inputs()[input]));
			}
		}
	}
}

/// Copies the positions of the points to the working memory.
void MeshRules::prepare(std::span<const MeshPoint> points, Scratch &r_scratch) const {
	r_scratch.positions.clear();
	r_scratch.heights.clear();
	for (const MeshPoint &point : points) {
		r_scratch.positions.push_back(point.position);
		if (on_surface_) {
			r_scratch.heights.push_back(point.ground.height);
		}
	}
}

/// Writes the densities of a mesh's rules at the points to `r_scratch.densities`, after `prepare`.
Status MeshRules::find_densities(const RuledMesh &mesh, std::span<const MeshPoint> points, Scratch &r_scratch) const {
	r_scratch.densities.resize(points.size());
	const PositionBatch batch{r_scratch.positions, r_scratch.heights};
	const Status status = mesh.rules.position_densities(batch, r_scratch.densities, r_scratch.fields);
	std::array<float, max_world_inputs> world;
	const std::span<const float> values = std::span<const float>(world).first(mesh.sources.size());
	for (std::size_t i = 0; status.ok() && i < points.size(); ++i) {
		for (std::size_t input = 0; input < mesh.sources.size(); ++input) {
			world[input] = points[i].world_values[mesh.sources[input]];
		}
		r_scratch.densities[i] *= mesh.rules.ground_density(points[i].ground, points[i].position, NoRecord(), values);
	}
	return status;
}

Status MeshRules::choose(
		std::span<const MeshPoint> points, std::span<std::uint8_t> r_meshes, Scratch &r_scratch) const {
	const std::size_t count = points.size();
	prepare(points, r_scratch);
	r_scratch.weights.resize(weights_.size() * count);
	for (std::size_t mesh = 0; mesh < weights_.size(); ++mesh) {
		std::fill_n(r_scratch.weights.data() + mesh * count, count, weights_[mesh]);
	}
	for (const RuledMesh &each : ruled_) {
		if (const Status status = find_densities(each, points, r_scratch); !status.ok()) {
			return status;
		}
		for (std::size_t i = 0; i < count; ++i) {
			r_scratch.weights[each.mesh * count + i] *= r_scratch.densities[i];
		}
	}
	for (std::size_t i = 0; i < count; ++i) {
		double sum = 0.0;
		for (std::size_t mesh = 0; mesh < weights_.size(); ++mesh) {
			sum += r_scratch.weights[mesh * count + i];
		}
		if (!(sum > 0.0)) {
			r_meshes[i] = static_cast<std::uint8_t>(plain_.mesh_for(seed_, points[i].id));
			continue;
		}
		const std::uint32_t word = MeshChoice::word_of(seed_, points[i].id);
		std::size_t chosen_index = 0;
		double before = 0.0;
		for (std::size_t mesh = 0; mesh < weights_.size(); ++mesh) {
			before += r_scratch.weights[mesh * count + i];
			chosen_index += word >= MeshChoice::end_of(before, sum) ? 1 : 0;
		}
		r_meshes[i] = static_cast<std::uint8_t>(chosen_index);
	}
	return {};
}

Status MeshRules::find_shares(const MeshPoint &point, std::vector<MeshShare> &r_shares) const {
	Scratch scratch;
	prepare({&point, 1}, scratch);
	r_shares.assign(plain_.size(), MeshShare{});
	for (std::size_t mesh = 0; mesh < weights_.size(); ++mesh) {
		r_shares[mesh].weight = weights_[mesh];
	}
	for (const RuledMesh &each : ruled_) {
		if (const Status status = find_densities(each, {&point, 1}, scratch); !status.ok()) {
			return status;
		}
		r_shares[each.mesh].density = scratch.densities.front();
		for (std::size_t input = 0; input < each.sources.size(); ++input) {
			r_shares[each.mesh].inputs.push_back(
					{each.rules.rules().expression->world_inputs()[input], point.world_values[each.sources[input]]});
		}
	}
	const auto sum_of = [&r_shares](const auto &weight_of) {
		return std::accumulate(r_shares.begin(), r_shares.end(), 0.0,
				[&weight_of](double sum, const MeshShare &share) { return sum + weight_of(share); });
	};
	const auto ruled_weight = [](const MeshShare &share) {
		return share.weight * share.density;
	};
	const double ruled_sum = sum_of(ruled_weight);
	const double plain_sum = sum_of([](const MeshShare &share) { return share.weight; });
	for (MeshShare &share : r_shares) {
		share.probability = ruled_sum > 0.0 ? ruled_weight(share) / ruled_sum : share.weight / plain_sum;
	}
	return {};
}

bool mesh_rules_need_slope(const LayerSettings &layer) {
	const GroundSides sides = layer.set.on_surface ? GroundSides::all : GroundSides::top;
	if (layer.mesh_weights.size() < 2) {
		// There is no choice.
		return false;
	}
	const std::size_t count = std::min(layer.mesh_rules.size(), layer.mesh_weights.size());
	for (std::size_t mesh = 0; mesh < count; ++mesh) {
		const std::optional<Rules> &rules = layer.mesh_rules[mesh];
		if (rules.has_value() && layer.mesh_weights[mesh] > 0.0f && needs_slope(*rules, sides)) {
			return true;
		}
	}
	return false;
}

} // namespace thicket
