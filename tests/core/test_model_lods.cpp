// Tests how the parts of a model are sorted into LODs.

#include "core/model/model_lods.hpp"

#include <doctest/doctest.h>

#include <optional>
#include <vector>

using namespace thicket;

namespace {

using Parts = std::vector<std::size_t>;

LodName unmarked(const char *name) { return {name, std::nullopt}; }

} // namespace

TEST_CASE("lod names: LOD markers are recognized in all common spellings") {
	CHECK(read_lod_name("Tree_LOD0") == LodName{"Tree", 0});
	CHECK(read_lod_name("tree_lod1") == LodName{"tree", 1});
	CHECK(read_lod_name("TrunkLOD2") == LodName{"Trunk", 2});
	CHECK(read_lod_name("LOD1") == LodName{"", 1});
	CHECK(read_lod_name("Lod_12") == LodName{"", 12});
	CHECK(read_lod_name("LOD1_Trunk") == LodName{"Trunk", 1});
	CHECK(read_lod_name("Tree-lod-1_leaves") == LodName{"Tree_leaves", 1});
	CHECK(read_lod_name("Tree LOD 3") == LodName{"Tree", 3});
	CHECK(read_lod_name("Tree_LOD0_001") == LodName{"Tree_001", 0});
	CHECK(read_lod_name("Oak.LOD2") == LodName{"Oak", 2});
	CHECK(read_lod_name("A_LOD1_LOD2") == LodName{"A_LOD1", 2});
}

TEST_CASE("lod names: names without an LOD marker have no number") {
	for (const char *name :
			{"", "Tree", "LOD", "LOD_", "Melod1", "Plod1", "LOD100", "LOD1b", "Lodge2", "LODx1", "lod--1"}) {
		CAPTURE(name);
		CHECK(read_lod_name(name) == unmarked(name));
	}
}

TEST_CASE("model lods: a model without LOD markers and ranges has one LOD") {
	const std::vector<PartRange> parts{{"Trunk", {}}, {"Leaves", {}}};
	CHECK(model_lods(parts) == std::vector<ModelLod>{{0.0, Parts{0, 1}}});
	CHECK(model_lods({}).empty());
}

TEST_CASE("model lods: numbers may have gaps, and ranges determine the distances") {
	const std::vector<PartRange> parts{
			{"Trunk", 0}, {"Leaves", 0}, {"Trunk", 2}, {"Leaves", 2, 40.0}, {"Card", 5, 90.0, 400.0}};
	CHECK(model_lods(parts) == std::vector<ModelLod>{{0.0, Parts{0, 1}}, {40.0, Parts{2, 3}}, {90.0, Parts{4}}});
	const std::vector<PartRange> without_ranges{{"Trunk", 1}, {"Trunk", 2}};
	CHECK(model_lods(without_ranges) == std::vector<ModelLod>{{0.0, Parts{0}}, {std::nullopt, Parts{1}}});
}

TEST_CASE("model lods: a part without a number is the finest of its name, or in all LODs") {
	const std::vector<PartRange> parts{{"Trunk", {}}, {"Trunk", 1}, {"Stone", {}}, {"Trunk", 2}};
	CHECK(model_lods(parts) ==
			std::vector<ModelLod>{{0.0, Parts{0, 2}}, {std::nullopt, Parts{1, 2}}, {std::nullopt, Parts{2, 3}}});
}

TEST_CASE("model lods: ranges determine the LODs if no name has an LOD marker") {
	const std::vector<PartRange> parts{
			{"Near", {}, 0.0, 30.0}, {"Far", {}, 30.0, 90.0}, {"All", {}}, {"Sign", {}, 10.0, 20.0}};
	CHECK(model_lods(parts) ==
			std::vector<ModelLod>{{0.0, Parts{0, 2}}, {10.0, Parts{0, 2, 3}}, {20.0, Parts{0, 2}}, {30.0, Parts{1, 2}},
					{90.0, Parts{2}}});
	const std::vector<PartRange> ending{{"Near", {}, 5.0, 30.0}, {"Far", {}, 30.0, 90.0}};
	CHECK(model_lods(ending) == std::vector<ModelLod>{{0.0, Parts{0}}, {30.0, Parts{1}}});
}

TEST_CASE("model lods: default distances grow with the size and from LOD to LOD") {
	CHECK(usual_lod_distance(10.0, 0) == 0.0);
	CHECK(usual_lod_distance(10.0, 1) == 25.0);
	CHECK(usual_lod_distance(10.0, 2) == 50.0);
	CHECK(usual_lod_distance(20.0, 3) == 200.0);
}
