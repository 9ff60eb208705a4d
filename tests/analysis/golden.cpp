// Prints digests of the core's results as JSON, for a fixed list of point sets, domains, surfaces,
// tiles, masks, states and queries. The program computes them with every instruction set that this
// processor supports, prints the name of each to stderr, and fails if any results differ.
// tests/golden/core.json contains the expected output. tests/golden/matrix.py compares the output
// of every platform, compiler and optimization level with it.

#include "tests/analysis/golden_fields.hpp"
#include "tests/analysis/golden_layers.hpp"
#include "tests/analysis/golden_planets.hpp"
#include "tests/analysis/golden_queries.hpp"
#include "tests/analysis/golden_states.hpp"
#include "tests/analysis/golden_surfaces.hpp"
#include "tests/bench/common/hills.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include "core/placement/tile_builder.hpp"
#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/set_digest.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/terrain/heightfield.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace thicket;

using Digests = std::vector<std::pair<std::string, std::uint64_t>>;

struct Case {
	const char *name;
	PointSet set;
	Rect rect;
};

const std::vector<Case> cases = {
		{"plain, around the origin", {.seed = 1, .radius = 1.0}, {{-60.0, -45.0}, {70.0, 52.5}}},
		{"plain, another seed and layer", {.seed = 0xfedcba9876543210, .radius = 0.37, .layer = 65535},
				{{1.0, 2.0}, {30.0, 40.0}}},
		{"plain, 5 000 km out", {.seed = 2, .radius = 1.5, .layer = 7},
				{{5.0e6, -4.9e6}, {5.0e6 + 100.0, -4.9e6 + 130.0}}},
		{"plain, the last cells of the world", {.seed = 3, .radius = 1e-3}, {{5931.60, 5931.60}, {5931.64, 5931.64}}},
		{"plain, a strip of kilometers", {.seed = 4, .radius = 50.0}, {{-9.0e4, 100.0}, {9.0e4, 400.0}}},
		{"two levels", {.seed = 5, .radius = 1.0, .levels = 2}, {{-80.0, 10.0}, {20.0, 90.0}}},
		{"four levels", {.seed = 6, .radius = 2.0, .levels = 4, .layer = 1}, {{-300.0, -300.0}, {-100.0, -100.0}}},
		{"eight levels, 5 000 km out", {.seed = 7, .radius = 1.0, .levels = 8, .layer = 2},
				{{-5.0e6, 5.0e6}, {-5.0e6 + 90.0, 5.0e6 + 90.0}}},
};

struct DomainCase {
	const char *name;
	DomainRequest request;
};

const std::vector<DomainCase> domain_cases = {
		{"naive, torus", {.size = {41.0, 33.0}, .seed = 9, .method = DomainMethod::naive, .toroidal = true}},
		{"naive, bounded", {.size = {9.0, 31.0}, .radius = 0.3, .seed = 10, .method = DomainMethod::naive}},
		{"hierarchical, torus", {.size = {90.0, 70.0}, .seed = 11, .toroidal = true}},
		{"hierarchical, bounded", {.size = {17.0, 51.5}, .radius = 0.37, .seed = 0xfedcba9876543210}},
		{"hierarchical, strip of kilometers", {.size = {3.0, 9000.0}, .radius = 2.5, .seed = 12}},
		{"accumulator, torus",
				{.size = {33.3, 155.0}, .seed = 13, .method = DomainMethod::accumulator, .toroidal = true}},
		{"accumulator, bounded", {.size = {2.0, 0.5}, .radius = 0.01, .seed = 14, .method = DomainMethod::accumulator}},
		{"wavefront, torus",
				{.size = {1e8, 7e7}, .radius = 1e6, .seed = 15, .method = DomainMethod::wavefront, .toroidal = true}},
		{"wavefront, bounded",
				{.size = {100.0, 75.5}, .seed = 16, .method = DomainMethod::wavefront, .cell_size = 20.0}},
};

[[noreturn]] void fail(const std::string &reason) {
	std::fprintf(stderr, "golden: %s\n", reason.c_str());
	std::exit(EXIT_FAILURE);
}

void require(const Status &status) {
	if (!status.ok()) {
		fail(describe(status));
	}
}

/// The digest does not depend on the order of the points, which may change. The ranks have a
/// separate digest, because improved rank tables may change them.
void digest_points(TileSampler &sampler, const Case &test_case, Digests &r_digests) {
	std::vector<SamplePoint> points;
	require(sampler.sample(test_case.set, test_case.rect, points));
	const SetDigest set_digest = digest(points);
	r_digests.emplace_back(test_case.name, set_digest.points);
	r_digests.emplace_back(std::string(test_case.name) + ": ranks", set_digest.ranks);
}

/// The digest covers the points in their order of acceptance.
template <typename Real>
void digest_domain(const DomainCase &domain_case, const char *precision, Digests &r_digests) {
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	require(sampler.sample(domain_case.request, points));
	r_digests.emplace_back(std::string("domain, ") + domain_case.name + ", " + precision, digest(points));
}

std::uint64_t digest_filled(const TileInstances &tile) {
	if (tile.counts.placed < 50) {
		fail("a tile is nearly empty");
	}
	return digest(tile);
}

std::uint64_t digest_tile(TileBuilder &builder, const LayerSettings &layer, glm::dvec2 corner) {
	static const Heightfield near_hills = bench::Hills::at(glm::dvec2(-5000.0, -3000.0));
	static const Heightfield far_hills = bench::Hills::at(glm::dvec2(5.0e6, 5.0e6));
	TileInstances tile;
	const Heightfield &hills = corner.x > 1e6 ? far_hills : near_hills;
	require(builder.build(layer, hills, {corner, corner + 200.0}, tile));
	return digest_filled(tile);
}

Digests all_digests() {
	Digests digests;
	TileSampler sampler;
	for (const Case &test_case : cases) {
		digest_points(sampler, test_case, digests);
	}
	for (const DomainCase &test_case : domain_cases) {
		digest_domain<float>(test_case, "single", digests);
		digest_domain<double>(test_case, "double", digests);
	}
	TileBuilder builder;
	const glm::dvec2 near(-150.0, 300.0);
	const glm::dvec2 far(5.0e6 + 2400.0, 5.0e6 + 3300.0);
	digests.emplace_back("forest on hills", digest_tile(builder, analysis::forest(), near));
	digests.emplace_back("forest on hills, 5 000 km out", digest_tile(builder, analysis::forest(), far));
	digests.emplace_back("mixed forest", digest_tile(builder, analysis::mixed_forest(), near));
	digests.emplace_back("mixed forest, 5 000 km out", digest_tile(builder, analysis::mixed_forest(), far));
	digests.emplace_back("undergrowth with every rule", digest_tile(builder, analysis::undergrowth(near), near));
	digests.emplace_back(
			"undergrowth with every rule, 5 000 km out", digest_tile(builder, analysis::undergrowth(far), far));
	digests.emplace_back("ferns that fill gaps", digest_tile(builder, analysis::filling_ferns(), near));
	digests.emplace_back("ferns that fill gaps, 5 000 km out", digest_tile(builder, analysis::filling_ferns(), far));
	digests.emplace_back("an avenue in rows", digest_tile(builder, analysis::in_rows(near, false), near));
	digests.emplace_back("an avenue in rows, 5 000 km out", digest_tile(builder, analysis::in_rows(far, false), far));
	digests.emplace_back("a field in rows", digest_tile(builder, analysis::in_rows(near, true), near));
	digests.emplace_back("a field in rows, 5 000 km out", digest_tile(builder, analysis::in_rows(far, true), far));
	for (const auto &extra_digests : {analysis::field_digests(require), analysis::state_digests(require),
				 analysis::query_digests("queries", {-50.0, 400.0}, require),
				 analysis::query_digests("queries, 5 000 km out", {5.0e6 + 2500.0, 5.0e6 + 3400.0}, require),
				 analysis::surface_digests(require), analysis::planet_digests(require, digest_filled)}) {
		digests.insert(digests.end(), extra_digests.begin(), extra_digests.end());
	}
	return digests;
}

} // namespace

int main() {
	Digests expected;
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		const bench::ForcedTarget forced(target);
		const Digests digests = all_digests();
		if (expected.empty()) {
			expected = digests;
		}
		for (std::size_t i = 0; i < digests.size(); ++i) {
			if (digests[i] != expected[i]) {
				fail(target.name + " differs: " + digests[i].first);
			}
		}
		std::fprintf(stderr, "golden: %s computed %zu digests\n", target.name.c_str(), digests.size());
	}
	std::printf("{\n");
	for (std::size_t i = 0; i < expected.size(); ++i) {
		std::printf("\t\"%s\": \"%016" PRIx64 "\"%s\n", expected[i].first.c_str(), expected[i].second,
				i + 1 < expected.size() ? "," : "");
	}
	std::printf("}\n");
}
