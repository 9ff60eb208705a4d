// Reads a list of tiles that an engine run has written, generates the same tiles on one thread with
// the core alone, and compares their digests.
//
// Usage: tile_digests FILE. Each line of the file describes one item in words, as
// tests/engine/tile_log.gd writes it:
//   flat HEIGHT
//   heightmap PATH COLUMNS ROWS MIN_X MIN_Z SIZE_X SIZE_Z MIN_HEIGHT MAX_HEIGHT
//   layer INDEX NUMBER... (LayerSettings in the order of `read_layer`)
//   tile LAYER TILE_SIZE X Y DIGEST
// Seeds, counts, coordinates and digests are whole numbers. All other numbers are the bits of a
// double, as a whole number. Ends with a line "tile_digests: N tiles, M instances, D differ". Exits
// with 0 if D is 0, 1 if not, 2 if the file is invalid.

#include "core/placement/tile_builder.hpp"
#include "core/base/tile_grid.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/heightfield.hpp"

#include <bit>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace thicket;

/// Reads a double that is written as the integer with the same bits.
struct Bits {
	double &value;
};

std::istream &operator>>(std::istream &line, Bits parsed_bits) {
	std::int64_t bits = 0;
	line >> bits;
	parsed_bits.value = std::bit_cast<double>(bits);
	return line;
}

struct Totals {
	std::size_t tiles = 0;
	std::size_t instances = 0;
	std::size_t different = 0;
};

class Comparison {
public:
	/// Processes one line. Returns false if it is invalid.
	bool take(std::istringstream &line) {
		std::string word;
		line >> word;
		if (word == "flat") {
			return read_flat(line);
		}
		if (word == "heightmap") {
			return read_heightmap(line);
		}
		if (word == "layer") {
			return read_layer(line);
		}
		return word == "tile" && compare_tile(line);
	}

	const Totals &totals() const { return totals_; }

private:
	bool read_flat(std::istringstream &line) {
		double height = 0.0;
		line >> Bits{height};
		terrain_ = std::make_unique<FlatTerrain>(static_cast<float>(height));
		return !line.fail();
	}

	bool read_heightmap(std::istringstream &line) {
		std::string path;
		HeightfieldFrame frame;
		glm::dvec2 size{0.0};
		line >> path >> frame.posts.x >> frame.posts.y;
		for (double *value :
				{&frame.area.min.x, &frame.area.min.y, &size.x, &size.y, &frame.min_height, &frame.max_height}) {
			line >> Bits{*value};
		}
		frame.area.max = frame.area.min + size;
		std::ifstream file(path, std::ios::binary);
		std::vector<std::uint16_t> posts;
		for (char bytes[2]; file.read(bytes, 2);) {
			posts.push_back(static_cast<std::uint16_t>(
					static_cast<unsigned char>(bytes[0]) | static_cast<unsigned char>(bytes[1]) << 8));
		}
		auto field = std::make_unique<Heightfield>();
		const bool set = field->set(frame, posts).ok();
		terrain_ = std::move(field);
		return set && !line.fail();
	}

	bool read_layer(std::istringstream &line) {
		std::size_t index = 0;
		std::int64_t seed = 0;
		LayerSettings layer;
		Rules &rules = layer.rules;
		Placement &placement = layer.placement;
		line >> index >> seed >> layer.set.levels >> layer.set.layer;
		for (double *value : {&layer.set.radius, &rules.density, &rules.min_slope_degrees, &rules.max_slope_degrees,
					 &rules.slope_falloff_degrees, &rules.min_height, &rules.max_height, &rules.height_falloff,
					 &placement.min_yaw_degrees, &placement.max_yaw_degrees, &placement.min_scale, &placement.max_scale,
					 &placement.align_to_normal, &placement.height_offset, &rules.clumping.size,
					 &rules.clumping.coverage, &rules.clumping.softness}) {
			line >> Bits{*value};
		}
		const bool is_complete = !line.fail();
		layer.set.seed = static_cast<std::uint64_t>(seed);
		double weight = 0.0;
		while (line >> Bits{weight}) {
			layer.mesh_weights.push_back(static_cast<float>(weight));
		}
		layers_[index] = layer;
		return is_complete && validate(layer).ok();
	}

	bool compare_tile(std::istringstream &line) {
		std::size_t index = 0;
		double size = 0.0;
		glm::ivec2 tile{0};
		std::int64_t expected = 0;
		line >> index >> Bits{size} >> tile.x >> tile.y >> expected;
		if (line.fail() || terrain_ == nullptr || layers_.count(index) == 0 ||
				!builder_.build(layers_[index], *terrain_, tile_rect(size, tile), instances_).ok()) {
			return false;
		}
		++totals_.tiles;
		for (const MeshInstances &mesh : instances_.meshes) {
			totals_.instances += mesh.size();
		}
		if (static_cast<std::int64_t>(digest(instances_)) != expected) {
			++totals_.different;
			std::printf("layer %zu, tile %d %d differs\n", index, tile.x, tile.y);
		}
		return true;
	}

	std::unique_ptr<Terrain> terrain_;
	std::map<std::size_t, LayerSettings> layers_;
	TileBuilder builder_;
	TileInstances instances_;
	Totals totals_;
};

} // namespace

int main(int argc, char **argv) {
	std::ifstream file(argc == 2 ? argv[1] : "");
	Comparison comparison;
	for (std::string text; std::getline(file, text);) {
		std::istringstream line(text);
		if (!comparison.take(line)) {
			std::fprintf(stderr, "tile_digests: cannot use this line: %s\n", text.c_str());
			return 2;
		}
	}
	const Totals &totals = comparison.totals();
	std::printf(
			"tile_digests: %zu tiles, %zu instances, %zu differ\n", totals.tiles, totals.instances, totals.different);
	if (totals.tiles == 0) {
		return 2;
	}
	return totals.different == 0 ? 0 : 1;
}
