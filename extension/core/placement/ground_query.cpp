#include "core/placement/ground_query.hpp"

#include "core/base/guard.hpp"

#include <algorithm>
#include <vector>

namespace thicket {

namespace {

/// Positions in one call of the terrain.
constexpr std::size_t batch = 2048;

/// Fewer are not worth the waking of a thread.
constexpr std::size_t portions_to_share = 8;

/// A few of the positions of a query.
struct Portion {
	std::size_t first;
	std::size_t count;
	std::span<const std::int32_t> textures;
	bool normals;
};

/// Cuts queries into portions, in order.
class Portions {
public:
	explicit Portions(std::span<const GroundQuery> queries) : queries_(queries) {}

	bool next(Portion &r_portion) {
		while (query_ < queries_.size() && done_ >= queries_[query_].count) {
			++query_;
			done_ = 0;
		}
		if (query_ == queries_.size()) {
			return false;
		}
		const GroundQuery &query = queries_[query_];
		r_portion = {query.first + done_, std::min(batch, query.count - done_), query.textures, query.normals};
		done_ += batch;
		return true;
	}

private:
	std::span<const GroundQuery> queries_;
	std::size_t query_ = 0;
	std::size_t done_ = 0;
};

Status ask(const Terrain &terrain, std::span<const glm::dvec2> positions, const Portion &portion,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel) {
	if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
		return {ErrorCode::cancelled, "tile", 0.0};
	}
	const std::span<const glm::dvec2> places = positions.subspan(portion.first, portion.count);
	const std::span<Ground> ground = r_ground.subspan(portion.first, portion.count);
	const Status status = portion.normals ? terrain.sample(places, ground) : terrain.sample_heights(places, ground);
	return status.ok() && !portion.textures.empty() ? terrain.weigh(places, portion.textures, ground) : status;
}

Status ask_together(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const Portion> portions,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel, LentThreads &threads) {
	struct Ended {
		std::size_t portion = 0;
		Status status;
	};
	std::vector<Ended> ended(threads.count() + 1);
	std::atomic<std::size_t> next = 0;
	threads.run([&](std::size_t index) {
		Ended &mine = ended[index];
		mine.status = guarded("ground", static_cast<double>(positions.size()), [&] {
			Status status;
			while (status.ok() && (mine.portion = next++) < portions.size()) {
				status = ask(terrain, positions, portions[mine.portion], r_ground, cancel);
			}
			return status;
		});
		if (!mine.status.ok()) {
			next = portions.size();
		}
	});
	// Portions are begun in order, so the first that failed is the one that a single thread would have met.
	const Ended *failed = nullptr;
	for (const Ended &each : ended) {
		if (!each.status.ok() && (failed == nullptr || each.portion < failed->portion)) {
			failed = &each;
		}
	}
	return failed != nullptr ? failed->status : Status{};
}

} // namespace

Status ask_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel, LentThreads *threads) {
	Portions portions(queries);
	Portion portion;
	if (threads != nullptr && threads->count() > 0 && positions.size() >= portions_to_share * batch) {
		std::vector<Portion> all;
		while (portions.next(portion)) {
			all.push_back(portion);
		}
		return ask_together(terrain, positions, all, r_ground, cancel, *threads);
	}
	while (portions.next(portion)) {
		if (const Status status = ask(terrain, positions, portion, r_ground, cancel); !status.ok()) {
			return status;
		}
	}
	return {};
}

} // namespace thicket
