#include "core/streaming/ground_recheck.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

constexpr std::size_t probes_per_visit = 2;

/// Maximum number of tiles that one call visits, including tiles that are not due.
constexpr std::size_t max_tiles_per_call = 64;

/// At this number of changes, `take_changes` stops waiting for more.
constexpr std::size_t many_changes = 32;

/// A change adds this amount to Tile::unrest, which doubles the pause. An unchanged height
/// subtracts 1.
constexpr unsigned unrest_of_change = 4;
constexpr unsigned max_unrest = 5 * unrest_of_change;

/// Returns the number of seconds between two checks of a tile.
double pause_of(unsigned unrest) {
	return GroundRecheck::pause * static_cast<double>(1U << (unrest / unrest_of_change));
}

bool differs(float a, float b, double tolerance) {
	if (!std::isfinite(a) || !std::isfinite(b)) {
		return std::isfinite(a) != std::isfinite(b);
	}
	return std::abs(double{a} - double{b}) > tolerance;
}

} // namespace

bool GroundRecheck::Before::operator()(const TileKey &a, const TileKey &b) const {
	return std::tie(a.layer, a.grid, a.tile.y, a.tile.x, a.slab) <
			std::tie(b.layer, b.grid, b.tile.y, b.tile.x, b.slab);
}

void GroundRecheck::show(const TileKey &key, const Rect &rect, std::vector<GroundProbe> probes, bool outdated) {
	Tile &tile = tiles_[key];
	tile.rect = rect;
	tile.probes = std::move(probes);
	tile.next = 0;
	tile.version = ++versions_;
	tile.is_suspended = outdated;
}

void GroundRecheck::hide(const TileKey &key) { tiles_.erase(key); }

void GroundRecheck::clear() {
	tiles_.clear();
	queried_.clear();
	changes_.clear();
}

void GroundRecheck::suspend(std::uint32_t layer, const Rect &area) {
	const TileKey first{.layer = layer, .grid = 0, .tile = glm::ivec2(std::numeric_limits<int>::min())};
	for (auto at = tiles_.lower_bound(first); at != tiles_.end() && at->first.layer == layer; ++at) {
		at->second.is_suspended = at->second.is_suspended || meet(at->second.rect, area);
	}
	std::erase_if(changes_, [&area, layer](const Change &change) {
		return change.layer == layer && meet({change.position, change.position}, area);
	});
}

void GroundRecheck::keep(const TileKey &key) {
	if (const auto found = tiles_.find(key); found != tiles_.end()) {
		found->second.is_suspended = false;
	}
}

void GroundRecheck::next(double now, std::size_t max_count, std::vector<glm::dvec2> &r_positions) {
	r_positions.clear();
	queried_.clear();
	auto at = tiles_.lower_bound(next_);
	for (std::size_t remaining = std::min(tiles_.size(), max_tiles_per_call);
			remaining > 0 && r_positions.size() < max_count; --remaining) {
		at = at != tiles_.end() ? at : tiles_.begin();
		visit(at->first, at->second, now, max_count, r_positions);
		++at;
	}
	next_ = at != tiles_.end() ? at->first : TileKey{.tile = glm::ivec2(std::numeric_limits<int>::min())};
}

void GroundRecheck::visit(
		const TileKey &key, Tile &r_tile, double now, std::size_t max_count, std::vector<glm::dvec2> &r_positions) {
	if (r_tile.is_suspended || now < r_tile.due) {
		return;
	}
	r_tile.due = now + pause_of(r_tile.unrest);
	const std::size_t wanted = std::min({probes_per_visit, r_tile.probes.size(), max_count - r_positions.size()});
	for (std::size_t i = 0; i < wanted; ++i) {
		queried_.push_back({key, r_tile.version, r_tile.next});
		r_positions.push_back(r_tile.probes[r_tile.next].position);
		r_tile.next = (r_tile.next + 1) % r_tile.probes.size();
	}
}

void GroundRecheck::answer(double now, std::span<const std::optional<float>> heights, double tolerance) {
	for (std::size_t i = 0; i < std::min(heights.size(), queried_.size()); ++i) {
		const auto found = tiles_.find(queried_[i].key);
		if (found == tiles_.end() || found->second.version != queried_[i].version || found->second.is_suspended ||
				!heights[i]) {
			continue;
		}
		Tile &tile = found->second;
		const GroundProbe &probe = tile.probes[queried_[i].probe];
		if (!differs(probe.height, *heights[i], tolerance)) {
			tile.unrest -= tile.unrest > 0 ? 1 : 0;
			continue;
		}
		first_change_ = changes_.empty() ? now : first_change_;
		changes_.push_back({queried_[i].key.layer, probe.position});
		tile.is_suspended = true;
		tile.unrest = std::min(max_unrest, tile.unrest + unrest_of_change);
		tile.due = now + pause_of(tile.unrest);
	}
	queried_.clear();
}

std::vector<glm::dvec2> GroundRecheck::take_changes(double now) {
	std::vector<glm::dvec2> positions;
	if (changes_.size() >= many_changes || now - first_change_ >= pause) {
		for (const Change &change : std::exchange(changes_, {})) {
			positions.push_back(change.position);
		}
	}
	return positions;
}

} // namespace thicket
