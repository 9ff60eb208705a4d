// Tests layers that grow on the models of other layers, which are called hosts.

#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_graph.hpp"
#include "core/placement/layer_links.hpp"
#include "core/placement/placed_models.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "counted_threads.hpp"
#include "placement_fixture.hpp"
#include "refusal.hpp"
#include "sources_fixture.hpp"
#include "surface_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// The changes in two lists that a test fills.
class ListedChanges final : public HostChanges {
public:
	std::set<std::uint64_t> gone;
	std::vector<HostInstance> placed;

	bool removed(std::uint64_t id) const override { return gone.contains(id); }
	Status add_placed(const Rect &rect, std::vector<HostInstance> &r_instances) const override {
		for (const HostInstance &instance : placed) {
			if (rect.contains({instance.position.x, instance.position.z})) {
				r_instances.push_back(instance);
			}
		}
		return {};
	}
	double max_scale() const override { return placed.empty() ? 0.0 : 2.0; }
};

/// Ground that computes normals only if they are required.
class SparingGround final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return all_.sample(positions, r_ground);
	}
	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		const Status status = sample(positions, r_ground);
		for (Ground &ground : r_ground) {
			ground.normal = {0.0f, 1.0f, 0.0f};
		}
		return status;
	}

private:
	Heightfield all_ = hills();
};

/// Returns the models of a layer with two meshes: a sphere, and a smaller one away from the origin.
std::shared_ptr<const HostModels> two_models() {
	surfaces::Triangles other = surfaces::sphere(0.8, 8);
	for (glm::dvec3 &vertex : other.vertices) {
		vertex += glm::dvec3(0.7, 0.5, 0.0);
	}
	return std::make_shared<const HostModels>(
			std::vector{surfaces::sphere(1.2, 12).surface(), std::shared_ptr<const Surface>(other.surface())});
}

LayerSettings boulders() {
	LayerSettings layer = rich_layer();
	layer.set.radius = 6.0;
	layer.set.levels = 1;
	layer.placement.max_scale = 1.5;
	layer.placement.offset_along_normal = 0.25;
	layer.mesh_weights = {2.0f, 1.0f};
	return layer;
}

LayerSettings moss_on(const LayerSettings &host, std::shared_ptr<const HostChanges> changes = nullptr) {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = 0.25, .levels = 1, .layer = 7, .on_surface = true};
	layer.rules.max_slope_degrees = 180.0;
	layer.placement.align_to_normal = 1.0;
	layer.hosted = true;
	layer.hosts = {{std::make_shared<const LayerSettings>(host), two_models(), std::move(changes)}};
	return layer;
}

/// Returns `layer` with these changes to the instances of its first host.
LayerSettings with_changes(LayerSettings layer, std::shared_ptr<const HostChanges> changes) {
	layer.hosts[0].changes = std::move(changes);
	return layer;
}

struct Placed {
	glm::dvec3 position;
	glm::dvec3 up;
	std::uint64_t mesh = 0;
	glm::dmat3 basis{1.0};
};

using AllPlaced = std::map<std::uint64_t, Placed>;

AllPlaced placed_in(const LayerSettings &layer, const Terrain &ground, const Rect &rect) {
	const TileInstances tile = built(layer, ground, rect);
	AllPlaced result;
	for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
		const MeshInstances &instances = tile.meshes[mesh];
		for (std::size_t i = 0; i < instances.size(); ++i) {
			const float *floats = instances.buffer.data() + i * instances.stride;
			Placed placed{world_position(tile, instances, i), {floats[1], floats[5], floats[9]}, mesh, {}};
			for (int row = 0; row < 3; ++row) {
				for (int column = 0; column < 3; ++column) {
					placed.basis[column][row] = floats[4 * row + column];
				}
			}
			CHECK(result.emplace(instances.ids[i], placed).second);
		}
	}
	return result;
}

constexpr Rect area{{-32.0, 0.0}, {32.0, 64.0}};
constexpr Rect wider{{-48.0, -16.0}, {48.0, 80.0}};

/// Returns the distance from a position to the surface of the nearest instance of a host.
double distance_to(const AllPlaced &hosts, const glm::dvec3 &position) {
	double min_distance = 1e9;
	for (const auto &[id, host] : hosts) {
		const glm::dvec3 center =
				host.position + (host.mesh == 0 ? glm::dvec3(0.0) : host.basis * glm::dvec3(0.7, 0.5, 0.0));
		const double radius = (host.mesh == 0 ? 1.2 : 0.8) * glm::length(host.basis[1]);
		min_distance = std::min(min_distance, std::abs(glm::distance(center, position) - radius));
	}
	return min_distance;
}

/// Returns true if any of many positions on a triangle is in a box.
bool enters(const std::array<glm::dvec3, 3> &corners, const Box3 &box) {
	constexpr int steps = 20;
	bool is_inside = false;
	for (int i = 0; i <= steps; ++i) {
		for (int j = 0; i + j <= steps; ++j) {
			const glm::dvec3 position =
					corners[0] + (corners[1] - corners[0]) * (i / 20.0) + (corners[2] - corners[0]) * (j / 20.0);
			is_inside = is_inside || touch({position, position}, box);
		}
	}
	return is_inside;
}

std::set<std::uint64_t> ids_of(const AllPlaced &placed) {
	std::set<std::uint64_t> ids;
	for (const auto &[id, each] : placed) {
		ids.insert(id);
	}
	return ids;
}

} // namespace

TEST_CASE("hosts: instances are on the models, apart from each other and without gaps") {
	const Heightfield ground = hills();
	const LayerSettings moss = moss_on(boulders());
	const AllPlaced hosts = placed_in(boulders(), ground, wider);
	const AllPlaced placed = placed_in(moss, ground, area);
	REQUIRE(hosts.size() > 30);
	REQUIRE(placed.size() > 3000);
	std::vector<SurfacePoint> points;
	for (const auto &[id, each] : placed) {
		CHECK(distance_to(hosts, each.position) < 0.06); // The models are not perfectly round.
		CHECK(std::abs(glm::length(each.up) - 1.0) < 1e-5);
		SurfacePoint point{};
		point.position = each.position;
		points.push_back(point);
	}
	const surfaces::PointCubes cubes(points, moss.set.radius);
	for (std::size_t i = 0; i < points.size(); ++i) {
		CHECK(cubes.nearest(points[i].position, i) > moss.set.radius - 1e-4);
	}
	std::mt19937 random(5);
	std::normal_distribution<double> normal;
	std::size_t tested = 0;
	for (const auto &[id, host] : hosts) {
		for (int i = 0; i < 40 && host.mesh == 0; ++i) {
			const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
			const glm::dvec3 position = host.position + 1.2 * glm::length(host.basis[1]) * direction;
			if (area.contains({position.x - 0.5, position.z - 0.5}) &&
					area.contains({position.x + 0.5, position.z + 0.5})) {
				++tested;
				CHECK(cubes.nearest(position) < moss.set.radius * 1.1);
			}
		}
	}
	CHECK(tested > 400);
}

TEST_CASE("hosts: models are aligned to the ground even if no rule needs its normals") {
	const SparingGround ground;
	LayerSettings host = boulders();
	host.rules = {};
	host.placement.align_to_normal = 1.0;
	host.placement.offset_along_normal = 2.0;
	const AllPlaced hosts = placed_in(host, ground, wider);
	const AllPlaced placed = placed_in(moss_on(host), ground, area);
	REQUIRE(placed.size() > 3000);
	for (const auto &[id, each] : placed) {
		CHECK(distance_to(hosts, each.position) < 0.06);
	}
}

TEST_CASE("hosts: the scales of models may depend on height, slope, or the distance to another layer") {
	const SparingGround ground;
	for (const SourceKind kind : {SourceKind::height, SourceKind::slope, SourceKind::distance}) {
		CAPTURE(static_cast<int>(kind));
		LayerSettings host = boulders();
		host.rules = {};
		host.placement.min_scale = 0.3;
		host.instance_data.scale = {source_of(kind)};
		const AllPlaced hosts = placed_in(host, ground, wider);
		const LayerSettings moss = moss_on(host);
		const AllPlaced all_placed = placed_in(moss, ground, area);
		REQUIRE(all_placed.size() > 1000);
		for (const auto &[id, each] : all_placed) {
			CHECK(distance_to(hosts, each.position) < 0.06);
		}
		AllPlaced joined_parts;
		for (double z = 0.0; z < 64.0; z += 16.0) {
			joined_parts.merge(placed_in(moss, ground, {{-32.0, z}, {32.0, z + 16.0}}));
		}
		CHECK(ids_of(joined_parts) == ids_of(all_placed));
	}
}

TEST_CASE("hosts: an edit of the layer that determines the scales of models affects what grows on them") {
	LayerSettings host = boulders();
	host.instance_data.scale = {source_of(SourceKind::distance)};
	const auto moss_with = [&host](const std::shared_ptr<const PaintedMask> &mask) {
		auto other = std::make_shared<LayerSettings>(*oaks());
		other->rules.mask = mask;
		host.instance_data.scale.layer = other;
		return moss_on(host);
	};
	const LayerSettings before = moss_with(painted_at({}));
	LayerSettings after = moss_with(painted_at(glm::dvec2(10.0, 0.0)));
	after.hosts[0].models = before.hosts[0].models;
	const EditedArea area = EditSearch().find(before, after);
	CHECK_FALSE(area.everywhere);
	CHECK(area.touches({{10.0 + farthest, 0.0}, {60.0, 1.0}}));
	CHECK_FALSE(area.touches({{15.0 + farthest + host_distance(before, reach_of(before.hosts[0])), 0.0}, {90.0, 1.0}}));
}

TEST_CASE("hosts: scales wait for a layer that fills gaps, so earlier tiles have no effect") {
	const Heightfield ground = hills();
	const auto stones = std::make_shared<const LayerSettings>(*oaks());
	auto bushes = std::make_shared<LayerSettings>(*oaks());
	bushes->set.layer = 11;
	bushes->set.radius = 5.0;
	bushes->neighbors = {{stones, 4.0, nullptr}};
	bushes->spacing_fills = true;
	LayerSettings host = boulders();
	host.placement.min_scale = 0.3;
	host.instance_data.scale = {source_of(SourceKind::distance)};
	host.instance_data.scale.layer = bushes;
	LayerSettings fern;
	fern.set = {.seed = 8, .radius = 1.0, .levels = 1, .layer = 12};
	fern.neighbors = {{std::make_shared<const LayerSettings>(moss_on(host)), 0.5, nullptr}};
	TileBuilder builder;
	for (const Rect &rect : {Rect{{-32.0, 0.0}, {-8.0, 24.0}}, Rect{{-26.0, 6.0}, {-2.0, 30.0}}}) {
		TileInstances tile;
		REQUIRE(builder.build(fern, ground, rect, tile).ok());
		REQUIRE(size_of(tile) > 50);
		CHECK(digest(tile) == digest(built(fern, ground, rect)));
	}
}

TEST_CASE("hosts: tiles of any size contain the same instances, bit for bit") {
	const Heightfield ground = hills();
	const LayerSettings moss = moss_on(boulders());
	const AllPlaced all_placed = placed_in(moss, ground, area);
	for (const double size : {16.0, 6.4, 1.0}) {
		AllPlaced joined_parts;
		const double end = size == 1.0 ? 8.0 : 64.0;
		for (double z = 0.0; z < end; z += size) {
			for (double x = -32.0; x < end - 32.0; x += size) {
				joined_parts.merge(placed_in(moss, ground, {{x, z}, {x + size, z + size}}));
			}
		}
		const Rect slice{area.min, area.min + end};
		for (const auto &[id, each] : all_placed) {
			REQUIRE(joined_parts.contains(id) == slice.contains({each.position.x, each.position.z}));
			if (joined_parts.contains(id)) {
				CHECK(joined_parts.at(id).basis == each.basis);
				CHECK(glm::distance(joined_parts.at(id).position, each.position) < 1e-5);
			}
		}
	}
}

TEST_CASE("hosts: a removed host takes its instances along, and a restored one brings them back") {
	const Heightfield ground = hills();
	const LayerSettings moss = moss_on(boulders());
	const AllPlaced hosts = placed_in(boulders(), ground, area);
	const AllPlaced before = placed_in(moss, ground, area);
	const auto felled_host = std::ranges::find_if(hosts, [](const auto &host) {
		return glm::distance(glm::dvec2(host.second.position.x, host.second.position.z), area.center()) < 10.0;
	});
	REQUIRE(felled_host != hosts.end());
	const auto changes = std::make_shared<ListedChanges>();
	changes->gone.insert(felled_host->first);
	const AllPlaced after = placed_in(with_changes(moss, changes), ground, area);
	AllPlaced host_instances = placed_in(boulders(), ground, wider);
	host_instances.erase(felled_host->first);
	const double reach_radius = reach_of(moss.hosts[0]) + surface_chain_reach * moss.set.radius;
	std::size_t removed_count = 0;
	for (const auto &[id, each] : before) {
		const glm::dvec3 offset = each.position - felled_host->second.position;
		removed_count += after.contains(id) ? 0 : 1;
		if (glm::length(glm::dvec2(offset.x, offset.z)) > reach_radius) {
			CHECK(after.contains(id));
		}
	}
	CHECK(removed_count > 50);
	for (const auto &[id, each] : after) {
		CHECK(distance_to(host_instances, each.position) < 0.06);
	}
	CHECK(ids_of(placed_in(with_changes(moss, std::make_shared<ListedChanges>()), ground, area)) == ids_of(before));
}

TEST_CASE("hosts: an instance that is placed by hand is a host, too, even mirrored or stretched") {
	const FlatTerrain ground(4.0);
	LayerSettings no_plants = boulders();
	no_plants.rules.density = 0.0;
	const auto changes = std::make_shared<ListedChanges>();
	changes->placed.push_back({.id = 1, .mesh = 0, .position = {3.0, 20.0, 30.0}, .basis = glm::dmat3(1.5)});
	changes->placed[0].basis[0].x = -1.5;
	changes->placed.push_back({.id = 2, .mesh = 0, .position = {-9.0, 20.0, 30.0}, .basis = glm::dmat3(0.0)});
	const AllPlaced placed = placed_in(moss_on(no_plants, changes), ground, area);
	CHECK(placed.size() > 200);
	for (const auto &[id, each] : placed) {
		const glm::dvec3 offset = each.position - changes->placed[0].position;
		CHECK(std::abs(glm::length(offset) - 1.8) < 0.06);
		CHECK(glm::dot(glm::normalize(offset), each.up) > 0.9);
	}
	CHECK(placed_in(moss_on(no_plants), ground, area).empty());
}

TEST_CASE("hosts: layers on hosts can have rules and neighbors, and can be hosts themselves") {
	const Heightfield ground = hills();
	LayerSettings moss = moss_on(boulders());
	const AllPlaced all = placed_in(moss, ground, area);
	moss.rules.max_slope_degrees = 40.0;
	const AllPlaced tops = placed_in(moss, ground, area);
	CHECK(tops.size() > 100);
	CHECK(tops.size() < all.size() / 3);
	for (const auto &[id, each] : tops) {
		CHECK(all.contains(id));
		CHECK(each.up.y > std::cos(0.7));
	}
	const auto caps = std::make_shared<const LayerSettings>(moss);
	LayerSettings flies = moss;
	flies.set.layer = 8;
	flies.set.radius = 0.1;
	flies.hosts = {{caps,
			std::make_shared<const HostModels>(
					std::vector{std::shared_ptr<const Surface>(surfaces::sphere(0.15, 8).surface())}),
			nullptr}};
	flies.rules.max_slope_degrees = 180.0;
	const Rect small{{-8.0, 20.0}, {8.0, 36.0}};
	const AllPlaced on_moss = placed_in(flies, ground, small);
	CHECK(on_moss.size() > 100);
	for (const auto &fly : on_moss) {
		CHECK(std::ranges::any_of(tops, [&fly](const auto &cap) {
			return std::abs(glm::distance(cap.second.position, fly.second.position) - 0.15) < 0.01;
		}));
	}
	LayerSettings separate = moss;
	separate.set.layer = 9;
	separate.neighbors = {{.layer = caps, .distance = 0.3, .curve = nullptr}};
	for (const auto &fly : placed_in(separate, ground, small)) {
		CHECK(std::ranges::none_of(tops,
				[&fly](const auto &cap) { return glm::distance(cap.second.position, fly.second.position) < 0.2999; }));
	}
}

TEST_CASE("hosts: the steps of a builder and its threads return the same tile") {
	const Heightfield ground = hills();
	const LayerSettings moss = moss_on(boulders());
	const TileInstances expected = built(moss, ground, area);
	TileBuilder builder;
	REQUIRE(builder.find_points(moss, area).ok());
	std::vector<Ground> heights(builder.positions().size());
	REQUIRE(query_ground(ground, builder.positions(), builder.queries(), heights).ok());
	for (int i = 0; i < 2; ++i) {
		TileInstances tile;
		REQUIRE(builder.place(heights, tile).ok());
		CHECK(digest(tile) == digest(expected));
		CHECK(builder.sample_stats().computed > 3000);
	}
	constexpr Rect large{{-150.0, -150.0}, {150.0, 150.0}};
	CountedThreads threads(2);
	TileInstances tile;
	REQUIRE(builder.build(moss, ground, large, tile, nullptr, &threads).ok());
	CHECK(threads.runs > 0);
	CHECK(digest(tile) == digest(built(moss, ground, large)));
}

TEST_CASE("hosts: settings without hosts place nothing, and a layer on hosts must be on surfaces") {
	const FlatTerrain ground(4.0);
	LayerSettings moss = moss_on(boulders());
	moss.hosts.clear();
	CHECK(placed_in(moss, ground, area).empty());
	moss.set.on_surface = false;
	CHECK(std::string_view(validate(moss).property) == "on_surfaces");
	moss = moss_on(boulders());
	moss.hosts[0].models = nullptr;
	CHECK(std::string_view(validate(moss).property) == "surface_layers");
	moss = moss_on(boulders());
	moss.hosts.assign(max_hosts + 1, moss.hosts[0]);
	CHECK(std::string_view(validate(moss).property) == "surface_layers");
}

TEST_CASE("hosts: on a planet, the height offset moves models sideways and is included in their reach") {
	LayerSettings host = boulders();
	host.set.on_surface = true;
	const double on_plane = reach_of(moss_on(host).hosts[0]);
	host.placement.height_offset = -5.0;
	CHECK(reach_of(moss_on(host).hosts[0]) == on_plane);
	host.planet = {{}, 100.0};
	CHECK(reach_of(moss_on(host).hosts[0]) == on_plane + 5.0);
}

TEST_CASE("hosts: the models are those that the host draws, without slope rules or with rules of meshes") {
	const SparingGround ground;
	LayerSettings open = boulders();
	open.rules = {};
	open.placement.align_to_normal = 1.0;
	LayerSettings mixed = open;
	mixed.mesh_rules.resize(2);
	for (const auto &[mesh, text] : {std::pair(0, "slope < 55"), std::pair(1, "slope >= 55")}) {
		ExpressionError error;
		mixed.mesh_rules[static_cast<std::size_t>(mesh)].emplace(open_rules()).expression =
				DensityExpression::compile(text, error);
	}
	for (const LayerSettings &host : {open, mixed}) {
		const AllPlaced hosts = placed_in(host, ground, wider);
		const AllPlaced placed = placed_in(moss_on(host), ground, area);
		REQUIRE(placed.size() > 3000);
		std::size_t misplaced = 0;
		for (const auto &[id, each] : placed) {
			misplaced += distance_to(hosts, each.position) < 0.06 ? 0 : 1;
		}
		CHECK(misplaced == 0);
	}
	CHECK(placed_in(open, ground, wider).size() == placed_in(mixed, ground, wider).size());
}

TEST_CASE("hosts: the error of a field in a host's rules of meshes is passed on") {
	LayerSettings host = boulders();
	host.mesh_rules = {open_rules()};
	host.mesh_rules[0]->fields = {std::make_shared<FailingField>()};
	TileBuilder builder;
	TileInstances tile;
	check_refused(builder.build(moss_on(host), hills(), area, tile), ErrorCode::wrong_type, "noise", 0.0);
}

TEST_CASE("hosts: edits of a host and of its instances reach the layers on it") {
	const LayerSettings moss = moss_on(boulders());
	const auto find = [&moss](const LayerSettings &after, HostEdits edits = {}) {
		return EditSearch(std::move(edits)).find(moss, after);
	};
	LayerSettings same = moss;
	CHECK(find(same).empty());
	EditedArea felled_area;
	felled_area.add({{10.0, 10.0}, {16.0, 16.0}});
	const auto changes = std::make_shared<ListedChanges>();
	const EditedArea area_of_felled = find(with_changes(moss, changes), {{boulders().set.layer, felled_area}});
	CHECK_FALSE(area_of_felled.everywhere);
	const double distance = host_distance(moss, reach_of(moss.hosts[0]));
	CHECK(area_of_felled.touches({{16.0 + distance - 0.1, 12.0}, {40.0, 13.0}}));
	CHECK_FALSE(area_of_felled.touches({{16.0 + 2.0 * distance, 12.0}, {40.0, 13.0}}));
	CHECK(distance < 9.0);
	CHECK(find(with_changes(moss, changes), {{4, felled_area}}).empty());
	for (int change = 0; change < 6; ++change) {
		LayerSettings host = boulders();
		LayerSettings after = moss;
		if (change == 0) {
			host.placement.max_scale = 2.0;
		} else if (change == 1) {
			host.mesh_weights = {1.0f, 1.0f};
		} else if (change == 2) {
			host.set.seed = 1;
		} else if (change == 3) {
			host.instance_data.scale = {source_of(SourceKind::height)};
		} else if (change == 4) {
			host.mesh_rules = {open_rules()};
		} else {
			after.hosts[0].models = two_models();
		}
		after.hosts[0].layer = std::make_shared<const LayerSettings>(host);
		CHECK(find(after).everywhere);
	}
	LayerSettings colored = boulders();
	colored.instance_data.use_colors = true;
	same.hosts[0].layer = std::make_shared<const LayerSettings>(colored);
	CHECK(find(same).empty());
}

TEST_CASE("hosts: links find the hosts, which come earlier and have models") {
	const LayerSettings stones = boulders();
	LayerSettings moss = moss_on(stones);
	moss.hosted = false;
	moss.hosts.clear();
	LayerLinks stone_links;
	stone_links.name = "stones";
	LayerLinks moss_links;
	moss_links.name = "moss";
	moss_links.surface_layers = {"stones", "trunks", "moss"};
	const auto models = two_models();
	const std::array<UnlinkedLayer, 2> layers{
			UnlinkedLayer{&stones, &stone_links, models, nullptr}, UnlinkedLayer{&moss, &moss_links, models, nullptr}};
	const auto linked = link_layers(layers, {});
	REQUIRE(linked[1].status.ok());
	REQUIRE(linked[1].settings->hosts.size() == 1);
	CHECK(linked[1].settings->hosts[0].layer == linked[0].settings);
	CHECK(linked[1].settings->hosts[0].models == models);
	const std::array<const LayerLinks *, 2> links{&stone_links, &moss_links};
	CHECK(name_problems(links, 1).size() == 2);
	const std::array<UnlinkedLayer, 2> swapped{layers[1], layers[0]};
	const auto late = link_layers(swapped, {});
	CHECK(late[0].settings->hosted);
	CHECK(late[0].settings->hosts.empty());
	moss.set.on_surface = false;
	CHECK_FALSE(link_layers(layers, {})[1].settings->hosted);
}

TEST_CASE("hosts: placed models are found like the triangles of one mesh") {
	const auto model = surfaces::sphere(1.0, 10).surface();
	std::mt19937 random(7);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	std::vector<PlacedModels::Part> parts;
	surfaces::Triangles all;
	for (std::uint64_t id = 0; id < 20; ++id) {
		HostInstance instance{.id = id, .mesh = 0, .position = {}, .basis = glm::dmat3(1.0)};
		for (int side = 0; side < 3; ++side) {
			instance.position[side] = 5000.0 + 8.0 * unit(random);
			instance.basis[side] = glm::dvec3(unit(random), unit(random), unit(random));
		}
		parts.push_back({model.get(), instance});
		for (std::uint32_t index = 0; index < model->triangle_count(); ++index) {
			for (const glm::dvec3 &corner : model->triangle(index)) {
				all.indices.push_back(static_cast<std::uint32_t>(all.vertices.size()));
				all.vertices.push_back(instance.position + instance.basis * corner);
			}
		}
	}
	const PlacedModels placed(parts, no_box);
	const auto expected = all.surface();
	REQUIRE(placed.triangle_count() == expected->triangle_count());
	std::vector<std::uint32_t> actual;
	std::vector<std::uint32_t> candidates;
	for (int i = 0; i < 200; ++i) {
		const glm::dvec3 center = 5000.0 + 9.0 * glm::dvec3(unit(random), unit(random), unit(random));
		const double half = 2.0 + 2.0 * unit(random);
		const Box3 box{center - half, center + half};
		placed.find(box, actual);
		expected->find(box, candidates);
		CHECK(std::ranges::is_sorted(actual));
		CHECK(std::ranges::includes(candidates, actual));
		for (const std::uint32_t index : candidates) {
			if (!std::ranges::binary_search(actual, index)) {
				CHECK_FALSE(enters(expected->triangle(index), box));
			}
		}
	}
}
