#include "track/clip/background.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { ROOM = 4 };

struct task {
	struct video_frame frame;
	double cam_from_head[4][4];
};

struct background {
	struct track_eyes *eyes;
	struct film *film;
	struct folds *folds;
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t changed;
	bool threaded, ending;
	long in, out;          // tasks handed over, and done
	struct task task[ROOM];
};

static void work(struct background *b, struct task *t)
{
	track_eyes_push(b->eyes, &t->frame, (const double(*)[4])t->cam_from_head);
	if (b->film)
		film_add(b->film, &t->frame);
	folds_add(b->folds, &t->frame);
	video_frame_free(&t->frame);
}

static void *run(void *data)
{
	struct background *b = data;
	for (;;) {
		pthread_mutex_lock(&b->lock);
		while (b->in == b->out && !b->ending)
			pthread_cond_wait(&b->changed, &b->lock);
		bool more = b->in != b->out;
		pthread_mutex_unlock(&b->lock);
		if (!more)
			return 0;
		work(b, &b->task[b->out % ROOM]);
		pthread_mutex_lock(&b->lock);
		b->out++;
		pthread_cond_broadcast(&b->changed);
		pthread_mutex_unlock(&b->lock);
	}
}

struct background *background_new(struct track_eyes *eyes, struct film *film, struct folds *folds)
{
	struct background *b = mem_new(1, sizeof *b);
	b->eyes = eyes;
	b->film = film;
	b->folds = folds;
	pthread_mutex_init(&b->lock, 0);
	pthread_cond_init(&b->changed, 0);
	b->threaded = pthread_create(&b->thread, 0, run, b) == 0;
	return b;
}

void background_push(struct background *b, struct video_frame *frame, const double cam_from_head[4][4])
{
	struct task task = { .frame = *frame };
	*frame = (struct video_frame){ 0 };
	memcpy(task.cam_from_head, cam_from_head, sizeof task.cam_from_head);
	if (!b->threaded) {
		work(b, &task);
		return;
	}
	pthread_mutex_lock(&b->lock);
	while (b->in - b->out == ROOM)
		pthread_cond_wait(&b->changed, &b->lock);
	b->task[b->in++ % ROOM] = task;
	pthread_cond_broadcast(&b->changed);
	pthread_mutex_unlock(&b->lock);
}

void background_wait(struct background *b)
{
	pthread_mutex_lock(&b->lock);
	while (b->in != b->out)
		pthread_cond_wait(&b->changed, &b->lock);
	pthread_mutex_unlock(&b->lock);
}

void background_end(struct background *b)
{
	if (b->threaded) {
		pthread_mutex_lock(&b->lock);
		b->ending = true;
		pthread_cond_broadcast(&b->changed);
		pthread_mutex_unlock(&b->lock);
		pthread_join(b->thread, 0);
	}
	pthread_mutex_destroy(&b->lock);
	pthread_cond_destroy(&b->changed);
	free(b);
}
