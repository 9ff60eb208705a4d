#pragma once

// Helpers for tests of the meshes that instances get.

#include "core/placement/tile_builder.hpp"
#include "core/rules/density_expression.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace thicket::test {

inline std::shared_ptr<const DensityExpression> compiled(const std::string &text) {
	ExpressionError error;
	auto expression = DensityExpression::compile(text, error);
	REQUIRE_MESSAGE(expression != nullptr, error.message);
	return expression;
}

/// The mesh of each instance, keyed by ID.
using Meshes = std::map<std::uint64_t, std::size_t>;

inline Meshes meshes_of(const TileInstances &tile) {
	Meshes meshes;
	for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
		for (const std::uint64_t id : tile.meshes[mesh].ids) {
			meshes.emplace(id, mesh);
		}
	}
	return meshes;
}

/// Returns the position of each point on the ground, keyed by ID.
inline std::map<std::uint64_t, glm::dvec2> positions_of(const LayerSettings &layer, const Rect &rect) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(layer.set, rect, points).ok());
	std::map<std::uint64_t, glm::dvec2> positions;
	for (const SamplePoint &point : points) {
		positions.emplace(point.id, point.position);
	}
	return positions;
}

} // namespace thicket::test
