#include "core/sampling/set_digest.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

namespace thicket {

namespace {

constexpr std::uint64_t empty_digest = 0xcbf29ce484222325;

/// Adds the bytes of a word, low byte first, to an FNV-1a hash.
void add(std::uint64_t &r_hash, std::uint64_t word) {
	for (int byte = 0; byte < 8; ++byte) {
		r_hash = (r_hash ^ (word >> (8 * byte) & 0xff)) * 0x100000001b3;
	}
}

template <typename Point>
std::uint64_t in_order(std::span<const Point> points) {
	std::uint64_t hash = empty_digest;
	add(hash, points.size());
	for (const Point &point : points) {
		add(hash, std::bit_cast<std::uint64_t>(static_cast<double>(point.x)));
		add(hash, std::bit_cast<std::uint64_t>(static_cast<double>(point.y)));
	}
	return hash;
}

} // namespace

SetDigest digest(std::span<const SamplePoint> points) {
	std::vector<const SamplePoint *> by_id(points.size());
	std::transform(points.begin(), points.end(), by_id.begin(), [](const SamplePoint &point) { return &point; });
	std::sort(by_id.begin(), by_id.end(), [](const SamplePoint *a, const SamplePoint *b) { return a->id < b->id; });
	SetDigest result{empty_digest, empty_digest};
	add(result.points, points.size());
	for (const SamplePoint *point : by_id) {
		add(result.points, point->id);
		add(result.points, std::bit_cast<std::uint64_t>(point->position.x));
		add(result.points, std::bit_cast<std::uint64_t>(point->position.y));
		add(result.points, point->level);
		add(result.ranks, point->rank);
	}
	return result;
}

std::uint64_t digest(std::span<const glm::vec2> points) { return in_order(points); }

std::uint64_t digest(std::span<const glm::dvec2> points) { return in_order(points); }

} // namespace thicket
