// Builds tiles from random heightfields and layers. Each must either be rejected or produce a tile
// that an engine can display.

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/placement/tile_builder.hpp"
#include "core/terrain/heightfield.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;

/// Returns a field around the origin, in most cases of at most 40 x 40 posts. If the posts are
/// rejected, the field must remain flat.
Heightfield read_field(Bytes &r_bytes) {
	Heightfield field;
	const std::vector<std::uint16_t> flat(4, 1000);
	require(field.set({{2, 2}, {{-100.0, -100.0}, {100.0, 100.0}}, 0.0, 100.0}, flat).ok(),
			"a valid field is accepted");
	HeightfieldFrame frame;
	frame.posts = {static_cast<int>(r_bytes.below(42)) - 1, static_cast<int>(r_bytes.below(42)) - 1};
	if (r_bytes.chance(32)) {
		frame.posts = {r_bytes.raw<std::int32_t>(), r_bytes.raw<std::int32_t>()};
	}
	frame.area.min = {r_bytes.number(-200.0, 0.0), r_bytes.number(-200.0, 0.0)};
	frame.area.max = {r_bytes.number(1.0, 200.0), r_bytes.number(1.0, 200.0)};
	frame.min_height = r_bytes.number(-100.0, 500.0);
	frame.max_height = r_bytes.number(0.0, 1000.0);
	const auto product = static_cast<std::int64_t>(frame.posts.x) * frame.posts.y;
	const std::size_t pixel_count = product > 0 && product < 2000 ? static_cast<std::size_t>(product) : 7;
	std::vector<std::uint16_t> posts(r_bytes.chance(16) ? r_bytes.below(2000) : pixel_count);
	for (std::uint16_t &post : posts) {
		post = r_bytes.raw<std::uint16_t>();
	}
	const HeightfieldFrame before = field.frame();
	if (!field.set(frame, posts).ok()) {
		require(field.frame().posts == before.posts, "a rejected field has no effect");
	}
	return field;
}

void check_field(const Heightfield &field, Bytes &r_bytes) {
	std::vector<glm::dvec2> positions;
	for (int i = 0; i < 16; ++i) {
		positions.emplace_back(r_bytes.number(-250.0, 250.0), r_bytes.number(-250.0, 250.0));
	}
	positions.push_back(field.frame().area.min);
	positions.push_back(field.frame().area.max);
	std::vector<Ground> ground(positions.size());
	require(field.sample(positions, ground).ok(), "positions without ground are no error");
	const HeightfieldFrame &frame = field.frame();
	const double slack = 1e-6 * (1.0 + std::abs(frame.min_height) + std::abs(frame.max_height));
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (std::isnan(ground[i].height)) {
			require(i < positions.size() - 2, "the corners of a field have ground");
			continue;
		}
		require(ground[i].height >= frame.min_height - slack && ground[i].height <= frame.max_height + slack,
				"a height lies between the lowest and the highest");
		const glm::vec3 normal = ground[i].normal;
		const float length = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
		require(normal.y >= 0.0f && std::abs(length - 1.0f) < 1e-4f, "a normal points up and has a length of 1");
	}
}

/// Adds random rules that depend on the surroundings of a point.
void read_surroundings(LayerSettings &r_layer, Bytes &r_bytes) {
	if (r_bytes.chance(2)) {
		r_layer.rules.clumping = {r_bytes.number(0.1, 50.0), r_bytes.number(0.0, 1.0), r_bytes.number(0.0, 1.0)};
	}
	r_layer.rules.edge_feather = r_bytes.chance(4) ? r_bytes.number(0.0, 10.0) : 0.0;
	for (std::uint32_t count = r_bytes.below(3); count > 0; --count) {
		auto other = std::make_shared<LayerSettings>();
		other->set = {r_layer.set.seed, r_bytes.number(1.0, 5.0), 1, static_cast<std::uint16_t>(count)};
		other->rules.density = r_bytes.number(0.0, 1.0);
		r_layer.neighbors.push_back({other, r_bytes.number(0.1, 10.0), nullptr});
	}
}

/// Adds random rules for biomes and water. If the map is rejected, the layer has no biomes.
void read_biomes(LayerSettings &r_layer, Bytes &r_bytes) {
	r_layer.rules.min_water_depth = r_bytes.chance(2) ? -unlimited_height : r_bytes.number(-100.0, 0.0);
	r_layer.rules.max_water_depth = r_bytes.number(0.0, 100.0);
	r_layer.rules.water_depth_falloff = r_bytes.number(0.0, 50.0);
	const auto map = std::make_shared<BiomeMap>();
	const glm::ivec2 size{static_cast<int>(r_bytes.below(20)), static_cast<int>(r_bytes.below(20))};
	std::vector<std::uint8_t> pixels(static_cast<std::size_t>(size.x * size.y));
	for (std::uint8_t &pixel : pixels) {
		pixel = static_cast<std::uint8_t>(r_bytes.below(4));
	}
	const Rect area{{r_bytes.number(-200.0, 0.0), r_bytes.number(-200.0, 0.0)},
			{r_bytes.number(0.5, 200.0), r_bytes.number(0.5, 200.0)}};
	const BiomeBorders borders{r_bytes.number(0.0, 30.0), r_bytes.number(0.0, 30.0), r_bytes.number(1.0, 90.0), 1};
	if (!r_bytes.chance(2) || !map->set(size, pixels, area, static_cast<BiomeEdge>(r_bytes.below(2)), borders).ok()) {
		return;
	}
	PerBiome<float> densities{};
	PerBiome<double> levels{};
	levels.fill(no_water);
	for (std::size_t biome = 0; biome < 4; ++biome) {
		densities[biome] = static_cast<float>(unit_density(static_cast<float>(r_bytes.number(0.0, 1.0))));
		levels[biome] = r_bytes.number(-100.0, 900.0);
	}
	r_layer.rules.biome = std::make_shared<BiomeDensity>(map, densities);
	r_layer.rules.water = std::make_shared<WaterLevels>(map, levels);
}

/// Adds colors and variations with random sources to some layers.
void read_appearance(LayerSettings &r_layer, Bytes &r_bytes) {
	const auto read_source = [&](InstanceSource &r_source) {
		r_source.kind = static_cast<SourceKind>(r_bytes.below(6));
		r_source.min = r_bytes.number(-50.0, 50.0);
		r_source.max = r_bytes.number(0.5, 60.0);
		r_source.randomness = r_bytes.number(0.0, 1.0);
		r_source.layer = r_layer.neighbors.empty() ? nullptr : r_layer.neighbors.back().layer;
	};
	if (r_bytes.chance(2)) {
		r_layer.instance_data.use_colors = true;
		r_layer.instance_data.colors = std::make_shared<ColorTable>(1 + r_bytes.below(5), glm::vec4(0.5f));
		read_source(r_layer.instance_data.color);
	}
	if (r_bytes.chance(2)) {
		r_layer.instance_data.use_custom_data = true;
		read_source(r_layer.instance_data.variation);
	}
}

LayerSettings read_layer(Bytes &r_bytes) {
	LayerSettings layer;
	layer.set = {
			r_bytes.raw<std::uint64_t>(), r_bytes.number(0.5, 5.0), 1 + r_bytes.below(4), r_bytes.raw<std::uint16_t>()};
	layer.rules.density = r_bytes.number(0.0, 1.0);
	layer.rules.min_slope_degrees = r_bytes.chance(2) ? 0.0 : r_bytes.number(0.0, 45.0);
	layer.rules.max_slope_degrees = r_bytes.chance(2) ? 90.0 : r_bytes.number(45.0, 90.0);
	layer.rules.slope_falloff_degrees = r_bytes.number(0.0, 30.0);
	layer.rules.min_height = r_bytes.chance(2) ? -unlimited_height : r_bytes.number(0.0, 300.0);
	layer.rules.max_height = r_bytes.chance(2) ? unlimited_height : r_bytes.number(300.0, 900.0);
	layer.rules.height_falloff = r_bytes.number(0.0, 100.0);
	layer.placement.min_yaw_degrees = r_bytes.number(-360.0, 0.0);
	layer.placement.max_yaw_degrees = r_bytes.number(0.0, 360.0);
	layer.placement.min_scale = r_bytes.number(0.1, 1.0);
	layer.placement.max_scale = r_bytes.number(1.0, 5.0);
	layer.placement.align_to_normal = r_bytes.number(0.0, 1.0);
	layer.placement.height_offset = r_bytes.number(-5.0, 5.0);
	layer.mesh_weights.resize(r_bytes.chance(16) ? r_bytes.below(400) : r_bytes.below(4));
	for (float &weight : layer.mesh_weights) {
		weight = static_cast<float>(r_bytes.number(0.0, 3.0));
	}
	const auto meshes = static_cast<std::uint32_t>(layer.mesh_weights.size());
	layer.mesh_rules.resize(r_bytes.chance(16) ? meshes + 2 : r_bytes.below(meshes + 1));
	for (std::optional<Rules> &rules : layer.mesh_rules) {
		if (r_bytes.chance(2)) {
			rules.emplace(open_rules());
			rules->density = r_bytes.number(0.0, 1.0);
			rules->max_height = r_bytes.number(300.0, 900.0);
			rules->height_falloff = r_bytes.number(0.0, 100.0);
		}
	}
	read_surroundings(layer, r_bytes);
	read_biomes(layer, r_bytes);
	read_appearance(layer, r_bytes);
	return layer;
}

void check_tile(const LayerSettings &layer, const TileInstances &tile) {
	require(tile.meshes.size() == std::max<std::size_t>(1, layer.mesh_weights.size()), "every mesh has its instances");
	std::size_t placed_count = 0;
	for (const MeshInstances &mesh : tile.meshes) {
		placed_count += mesh.size();
		const std::size_t stride = floats_per_instance(layer.instance_data);
		require(mesh.buffer.size() == stride * mesh.size() && mesh.ranks.size() == mesh.size(),
				"the sizes of buffers match");
		require(std::is_sorted(mesh.ranks.begin(), mesh.ranks.end()), "ranks ascend");
		require(std::all_of(mesh.buffer.begin(), mesh.buffer.end(), [](float value) { return std::isfinite(value); }),
				"transforms are finite");
		for (std::size_t i = 0; layer.instance_data.use_custom_data && i < mesh.size(); ++i) {
			const float variation = mesh.buffer[(i + 1) * stride - 4];
			require(variation >= 0.0f && variation <= 1.0f, "a variation is between 0 and 1");
		}
	}
	require(placed_count == tile.counts.placed && tile.counts.placed <= tile.counts.dense &&
					tile.counts.dense <= tile.counts.sampled,
			"counts add up");
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	static TileBuilder builder;
	Bytes bytes(data, size);
	const LayerSettings layer = read_layer(bytes);
	Rect rect;
	rect.min = {bytes.number(-150.0, 100.0), bytes.number(-150.0, 100.0)};
	rect.max = rect.min + glm::dvec2(bytes.number(0.0, 60.0), bytes.number(0.0, 60.0));
	const Heightfield field = read_field(bytes);
	check_field(field, bytes);

	const std::atomic<bool> cancel{true};
	const double side = std::max(rect.size().x, rect.size().y);
	const bool small = points_to_sample(layer, side) < 200000.0 && side < 1000.0 * layer.set.radius;
	TileInstances tile, rebuilt;
	const Status status = builder.build(layer, field, rect, tile, small ? nullptr : &cancel);
	if (status.ok()) {
		check_tile(layer, tile);
		require(TileBuilder().build(layer, field, rect, rebuilt).ok() && digest(tile) == digest(rebuilt),
				"the same call produces the same tile");
	} else if (status.code != ErrorCode::cancelled) {
		require(tile.meshes.empty(), "a rejected call has no effect");
		require(describe(status).find(status.property) == 0, "an error names the property");
	}
	return 0;
}
