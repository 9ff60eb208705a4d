#pragma once

#include "random.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// Bridson, "Fast Poisson disk sampling in arbitrary dimensions" (2007), in two dimensions, tuned:
/// the fast baseline for the sampler. It uses single precision, a background grid with cells of
/// side r / sqrt(2) that store the positions, a border of two empty cells instead of bounds checks,
/// and an unordered active list. Candidates are drawn by rejection from the square around the
/// annulus, which was measured to be faster than sine and cosine. The sets are not maximal, and not
/// distributed like those of dart throwing. An object of this class keeps its memory between calls.
class Bridson {
public:
	/// The number of candidates around an active point before it becomes inactive, as in the paper.
	static constexpr int attempts = 30;

	/// Replaces `r_points` with a set in [0, size.x) x [0, size.y) in which no two points are
	/// closer than 1. Both sizes must be > 0.
	void sample(glm::vec2 size, std::uint64_t seed, std::vector<glm::vec2> &r_points) {
		size_ = size;
		columns_ = static_cast<int>(size.x * per_cell) + 1 + 2 * border;
		const int rows = static_cast<int>(size.y * per_cell) + 1 + 2 * border;
		grid_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), glm::vec2(far_away));
		r_points.clear();
		active_.clear();

		Xoroshiro random(seed);
		const std::uint64_t bits = random();
		const glm::vec2 first = glm::vec2(unit(bits >> 40), unit(bits >> 16 & 0xffffff)) * size;
		insert({std::min(first.x, std::nextafter(size.x, 0.0f)), std::min(first.y, std::nextafter(size.y, 0.0f))},
				r_points);
		while (!active_.empty()) {
			const std::uint32_t slot = random.below(static_cast<std::uint32_t>(active_.size()));
			if (!grow(active_[slot], random, r_points)) {
				active_[slot] = active_.back();
				active_.pop_back();
			}
		}
	}

private:
	static constexpr float per_cell = 1.41421356f;
	static constexpr float far_away = -1e9f;
	static constexpr int border = 2;

	glm::vec2 size_{0.0f};
	int columns_ = 0;
	std::vector<glm::vec2> grid_;
	std::vector<glm::vec2> active_;

	static float unit(std::uint64_t bits24) { return static_cast<float>(bits24) * 0x1p-24f; }

	std::size_t cell_of(glm::vec2 point) const {
		const int x = static_cast<int>(point.x * per_cell) + border;
		const int y = static_cast<int>(point.y * per_cell) + border;
		return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
	}

	void insert(glm::vec2 point, std::vector<glm::vec2> &r_points) {
		grid_[cell_of(point)] = point;
		active_.push_back(point);
		r_points.push_back(point);
	}

	/// Tries up to `attempts` candidates around `parent`. Returns true if one was added.
	bool grow(glm::vec2 parent, Xoroshiro &random, std::vector<glm::vec2> &r_points) {
		for (int attempt = 0; attempt < attempts; ++attempt) {
			const glm::vec2 candidate = parent + annulus(random);
			const bool is_inside =
					candidate.x >= 0.0f && candidate.y >= 0.0f && candidate.x < size_.x && candidate.y < size_.y;
			if (is_inside && free(candidate)) {
				insert(candidate, r_points);
				return true;
			}
		}
		return false;
	}

	/// Returns a uniform random vector in the annulus between radii 1 and 2.
	static glm::vec2 annulus(Xoroshiro &random) {
		for (;;) {
			const std::uint64_t bits = random();
			const glm::vec2 offset(static_cast<float>(static_cast<std::int32_t>(bits >> 32)) * 0x1p-30f,
					static_cast<float>(static_cast<std::int32_t>(bits)) * 0x1p-30f);
			const float squared = offset.x * offset.x + offset.y * offset.y;
			if (squared >= 1.0f && squared < 4.0f) {
				return offset;
			}
		}
	}

	bool free(glm::vec2 candidate) const {
		const glm::vec2 *row = grid_.data() + cell_of(candidate) - 2 * columns_ - 2;
		for (int y = 0; y < 5; ++y, row += columns_) {
			for (int x = 0; x < 5; ++x) {
				const float dx = row[x].x - candidate.x;
				const float dy = row[x].y - candidate.y;
				if (dx * dx + dy * dy < 1.0f) {
					return false;
				}
			}
		}
		return true;
	}
};

} // namespace thicket::bench
