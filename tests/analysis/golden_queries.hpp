#pragma once

#include "tests/analysis/golden_layers.hpp"
#include "tests/analysis/golden_states.hpp"
#include "tests/bench/common/hills.hpp"

#include "core/base/tile_grid.hpp"
#include "core/base/word_hash.hpp"
#include "core/near/body_fit.hpp"
#include "core/near/near_set.hpp"
#include "core/near/tile_overlay.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/query/instance_query.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket::analysis {

/// A world of hills with two layers: a forest, and bushes whose tiles are narrower than the radius
/// of their point set. It generates tiles on request and caches them.
class GoldenWorld final : public TileSource {
public:
	/// Moves the hills so that trees grow around `position`.
	explicit GoldenWorld(glm::dvec2 position) : hills_(bench::Hills::at(position - glm::dvec2(4950.0, 3400.0))) {
		LayerSettings bushes = forest();
		bushes.set = {.seed = 9, .radius = 7.0, .levels = 1, .layer = 12};
		bushes.placement.offset_along_normal = 0.4;
		bushes.placement.max_tilt_degrees = 20.0;
		settings_ = {forest(), bushes};
		for (const auto &[layer, tile_size] : {std::pair{0, 64.0}, std::pair{1, 5.5}}) {
			const LayerSettings &settings = settings_[static_cast<std::size_t>(layer)];
			query_layers.push_back({.set = settings.set,
					.tile_size = tile_size,
					.shape = {.radius = 0.6, .height = 7.0},
					.max_scale = settings.placement.max_scale,
					.max_offset = std::abs(settings.placement.offset_along_normal)});
		}
	}

	std::vector<QueryLayer> query_layers;

	Status find_tile(const WorldTile &requested, std::shared_ptr<const CompactTile> &r_tile) override {
		const auto &[layer, tile, slab] = requested;
		std::shared_ptr<const CompactTile> &cached = tiles_[{layer, tile.x, tile.y}];
		if (cached == nullptr) {
			TileInstances generated;
			const Rect square = tile_rect(query_layers[layer].tile_size, tile);
			if (const Status status = builder_.build(settings_[layer], hills_, square, generated); !status.ok()) {
				return status;
			}
			cached = std::make_shared<const CompactTile>(generated, std::make_shared<LayerSettings>(settings_[layer]));
		}
		r_tile = cached;
		return {};
	}

	const LayerSettings &settings(std::uint32_t layer) const { return settings_[layer]; }

private:
	Heightfield hills_;
	std::vector<LayerSettings> settings_;
	TileBuilder builder_;
	std::map<std::tuple<std::uint32_t, int, int>, std::shared_ptr<const CompactTile>> tiles_;
};

inline void add(WordHash &r_hash, const glm::mat3 &matrix) {
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			r_hash.add(matrix[column][row]);
		}
	}
}

inline void add(WordHash &r_hash, const PlacedInstance &instance) {
	r_hash.add(instance.id);
	r_hash.add(instance.layer);
	r_hash.add(instance.mesh);
	for (int axis = 0; axis < 3; ++axis) {
		r_hash.add(instance.position[axis]);
	}
	add(r_hash, instance.basis);
}

inline std::uint64_t digest_of(const std::vector<PlacedInstance> &instances) {
	WordHash hash;
	hash.add(std::uint64_t{instances.size()});
	for (const PlacedInstance &each : instances) {
		add(hash, each);
	}
	return hash.value();
}

/// Returns a state that removes about a fifth of `all` and adds 30 hand-placed instances around
/// `position`.
template <typename Require>
InstanceState changed_world(const std::vector<PlacedInstance> &all, glm::dvec3 position, Require require) {
	GoldenRandom random(23);
	InstanceState state;
	for (const PlacedInstance &each : all) {
		if (random.below(5) == 0) {
			require(state.remove(each.id).status);
		}
	}
	for (int i = 0; i < 30; ++i) {
		std::uint64_t id = 0;
		require(state.add(golden_instance(random, static_cast<std::uint16_t>(i % 2 == 0 ? 4 : 12), position), id));
	}
	return state;
}

/// Hashes the first hits of random rays and the instances nearest to random positions around
/// `position`. The number of hits is added to `r_met`.
template <typename Require>
void add_first_ones(const InstanceQuery &query, glm::dvec3 position, WordHash &r_rays, WordHash &r_nearest,
		std::uint64_t &r_met, Require require) {
	GoldenRandom random(29);
	const auto anywhere = [&] {
		const double x = random.between(-90, 90);
		const double z = random.between(-90, 90);
		return position + glm::dvec3(x, random.between(-30, 30), z);
	};
	for (int i = 0; i < 150; ++i) {
		std::vector<RayHit> hits;
		const glm::dvec3 from = anywhere();
		require(query.on_ray(from, anywhere(), {}, hits));
		r_met += hits.size();
		for (const RayHit &hit : hits) {
			r_rays.add(hit.distance);
			add(r_rays, hit.instance);
		}
		std::vector<NearestInstance> nearest;
		require(query.nearest(anywhere(), 25.0, {}, nearest));
		for (const NearestInstance &result : nearest) {
			r_nearest.add(result.distance);
			add(r_nearest, result.instance);
		}
	}
}

/// Returns a digest of the instances that enter and leave as a viewer walks past, and of the bodies
/// that are fitted to them.
inline std::uint64_t digest_walk(const std::vector<PlacedInstance> &present, glm::dvec3 position) {
	WordHash hash;
	NearSet near_set;
	NearChanges changes;
	for (int step = -4; step <= 4; ++step) {
		const std::vector<glm::dvec3> centers{position + glm::dvec3(step * 11.3, 0.0, step * 7.1), position};
		near_set.find_changes(centers, {30.0, 40.0}, present, changes);
		for (const NearRelease &leaving : changes.leave) {
			hash.add(leaving.id);
			near_set.release(leaving.id);
		}
		for (const PlacedInstance &each : changes.enter) {
			BodyFit fit;
			hash.add(each.id);
			hash.add(std::uint32_t{fit_body(each.basis, fit)});
			hash.add(std::uint32_t{fit.mirrored});
			add(hash, fit.rotation);
			for (int axis = 0; axis < 3; ++axis) {
				hash.add(static_cast<std::uint32_t>(fit.scale_steps[axis]));
				hash.add(fit.scale()[axis]);
			}
			near_set.retain(each);
		}
	}
	return hash.value();
}

/// Returns a digest of the meshes that are displayed for a tile after the state has changed its
/// instances.
template <typename Require>
std::uint64_t digest_overlay(GoldenWorld &world, const InstanceState &state, glm::dvec3 position, Require require) {
	const glm::ivec2 tile = tile_at(world.query_layers[0].tile_size, {position.x, position.z});
	std::shared_ptr<const CompactTile> stored_tile;
	require(world.find_tile({0, tile}, stored_tile));
	OverlaidMeshes meshes;
	require(overlaid(stored_tile, world.settings(0), tile_rect(world.query_layers[0].tile_size, tile),
			{&state, nullptr}, meshes));
	WordHash hash;
	for (const std::shared_ptr<const CompactMesh> &cached : meshes) {
		const MeshInstances mesh = expanded(*cached);
		hash.add_all(std::span<const std::uint64_t>(mesh.ids));
		hash.add_all(std::span<const std::uint32_t>(mesh.ranks));
		hash.add_all(std::span<const float>(mesh.buffer));
	}
	return hash.value();
}

/// Returns digests of all kinds of query around `position` in a world with changed instances. The
/// queries include the instances near a walking viewer and a displayed tile.
template <typename Require>
std::vector<std::pair<std::string, std::uint64_t>> query_digests(
		const std::string &title, glm::dvec2 position, Require require) {
	GoldenWorld world(position);
	const Rect rect{position - glm::dvec2(90.25, 80.5), position + glm::dvec2(80.75, 95.125)};
	std::vector<PlacedInstance> all;
	require(InstanceQuery{world.query_layers, world}.in_rect(rect, {}, all));
	// The queries below use the height of an instance from the middle of the list.
	const glm::dvec3 center(position.x, all.empty() ? 0.0 : all[all.size() / 2].position.y, position.y);
	const InstanceState state = changed_world(all, center, require);
	const InstanceQuery query{world.query_layers, world, &state};

	std::vector<PlacedInstance> in_rect;
	std::vector<PlacedInstance> in_sphere;
	std::vector<PlacedInstance> by_id;
	require(query.in_rect(rect, {}, in_rect));
	require(query.in_sphere(center, 70.3, {}, in_sphere));
	for (std::size_t i = 0; i < all.size(); i += 3) {
		std::vector<PlacedInstance> results;
		require(query.by_id(all[i].id, results));
		by_id.insert(by_id.end(), results.begin(), results.end());
	}
	WordHash rays;
	WordHash nearest;
	std::uint64_t hit_count = 0;
	add_first_ones(query, center, rays, nearest, hit_count, require);
	if (in_rect.size() < 400 || in_sphere.size() < 100 || by_id.size() < 100 || hit_count < 30) {
		require(Status{ErrorCode::out_of_range, "instances that queries find", static_cast<double>(in_rect.size())});
	}
	return {{title + ", in a rectangle", digest_of(in_rect)}, {title + ", in a sphere", digest_of(in_sphere)},
			{title + ", by id", digest_of(by_id)}, {title + ", on rays", rays.value()},
			{title + ", nearest", nearest.value()}, {title + ", near a walker", digest_walk(in_rect, center)},
			{title + ", drawn", digest_overlay(world, state, center, require)}};
}

} // namespace thicket::analysis
