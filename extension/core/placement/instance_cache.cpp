#include "core/placement/instance_cache.hpp"

#include <mutex>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

/// Maximum number of cached blocks. Empty blocks take memory, too.
constexpr std::size_t most_blocks = 8192;

glm::dvec2 position_of(glm::dvec2 position) { return position; }
glm::dvec2 position_of(const CachedPoint &point) { return point.position; }

template <class Item>
void sort(std::vector<Item> &r_items) {
	std::ranges::sort(r_items, [](const Item &a, const Item &b) {
		const glm::dvec2 first = position_of(a);
		const glm::dvec2 second = position_of(b);
		return std::tie(first.y, first.x) < std::tie(second.y, second.x);
	});
}

/// Calls `visit` with each item of a sorted list in `rect`.
template <class Item, class Visit>
void visit_in(const Rect &rect, const std::vector<Item> &items, const Visit &visit) {
	const auto y_of = [](const Item &item) {
		return position_of(item).y;
	};
	for (auto at = std::ranges::lower_bound(items, rect.min.y, {}, y_of); at != items.end() && y_of(*at) < rect.max.y;
			++at) {
		if (rect.contains(position_of(*at))) {
			visit(*at);
		}
	}
}

} // namespace

InstanceBlock::InstanceBlock(
		std::vector<glm::dvec2> instances, std::vector<CachedPoint> points, std::vector<glm::dvec2> sampled) :
		instances_(std::move(instances)), points_(std::move(points)), sampled_(std::move(sampled)) {
	sort(instances_);
	sort(points_);
	sort(sampled_);
}

void InstanceBlock::add_instances(const Rect &rect, std::vector<glm::dvec2> &r_positions) const {
	visit_in(rect, instances_, [&](glm::dvec2 position) { r_positions.push_back(position); });
}

std::size_t InstanceBlock::add_points(const Rect &rect, std::vector<CachedPoint> &r_points) const {
	std::size_t count = 0;
	visit_in(rect, points_, [&](const CachedPoint &point) { r_points.push_back(point); });
	visit_in(rect, sampled_, [&](glm::dvec2) { ++count; });
	return count;
}

std::size_t InstanceBlock::bytes() const {
	return sizeof *this + (instances_.capacity() + sampled_.capacity()) * sizeof(glm::dvec2) +
			points_.capacity() * sizeof(CachedPoint);
}

bool InstanceCache::Key::operator<(const Key &other) const {
	return std::tie(layer, ground, block.y, block.x) <
			std::tie(other.layer, other.ground, other.block.y, other.block.x);
}

InstanceCache::Claim::~Claim() {
	if (cache_ != nullptr) {
		cache_->give_up(key_);
	}
}

std::shared_ptr<const InstanceBlock> InstanceCache::find(const Key &key, Claim &r_claim) {
	const std::lock_guard lock(mutex_);
	const auto [at, is_new] = entries_.try_emplace(key);
	at->second.used = ++clock_;
	if (is_new) {
		r_claim.cache_ = this;
		r_claim.key_ = key;
	}
	return at->second.block;
}

void InstanceCache::add(const Key &key, std::shared_ptr<const InstanceBlock> block) {
	const std::lock_guard lock(mutex_);
	Entry &entry = entries_[key];
	if (entry.block != nullptr) {
		// A different caller generated the same block at the same time.
		return;
	}
	bytes_ += block->bytes();
	entry = {std::move(block), ++clock_};
	trim();
}

/// Removes a block that its caller did not generate.
void InstanceCache::give_up(const Key &key) {
	const std::lock_guard lock(mutex_);
	if (const auto at = entries_.find(key); at != entries_.end() && at->second.block == nullptr) {
		entries_.erase(at);
	}
}

void InstanceCache::trim() {
	while (bytes_ > limit_ || entries_.size() > most_blocks) {
		const auto oldest = std::ranges::min_element(entries_, {}, [](const auto &entry) { return entry.second.used; });
		bytes_ -= oldest->second.block != nullptr ? oldest->second.block->bytes() : 0;
		entries_.erase(oldest);
	}
}

std::size_t InstanceCache::bytes() const {
	const std::lock_guard lock(mutex_);
	return bytes_;
}

} // namespace thicket
