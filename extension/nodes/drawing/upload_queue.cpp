#include "nodes/drawing/upload_queue.hpp"

#include <utility>

namespace thicket {

void UploadQueue::push(std::shared_ptr<TileJob> job) {
	const std::uint64_t ticket = job->request.ticket;
	waiting_tiles_[ticket].job = std::move(job);
}

bool UploadQueue::choose(std::uint64_t ticket) {
	auto node = waiting_tiles_.extract(ticket);
	if (node.empty()) {
		return false;
	}
	current_ = std::move(node.mapped());
	state_ = State::uploading;
	part_uploaded(); // The upload may already have been complete when it was put back.
	return true;
}

void UploadQueue::part_uploaded() {
	if (current_.is_complete()) {
		state_ = State::complete;
	}
}

TileUpload UploadQueue::take() {
	state_ = State::idle;
	return std::exchange(current_, TileUpload());
}

void UploadQueue::put_back() {
	const std::uint64_t ticket = current_.job->request.ticket;
	waiting_tiles_[ticket] = take();
}

std::optional<TileUpload> UploadQueue::remove(std::uint64_t ticket) {
	if (state_ != State::idle && current_.job->request.ticket == ticket) {
		return take();
	}
	auto node = waiting_tiles_.extract(ticket);
	return node.empty() ? std::nullopt : std::optional(std::move(node.mapped()));
}

void UploadQueue::clear() {
	take();
	waiting_tiles_.clear();
}

} // namespace thicket
