/* The interface of plug-ins: shared objects that give a model forces which `mbd run --plugin FILE` (in C++: mbd::use_plugin)
   evaluates inside Newton's iterations. Plain C, so a plug-in needs neither libmbd nor its compiler: this header is all.

   A plug-in has one function, mbd_get_plugin(), which tells what it gives:

     static int pull(void* self, const struct mbd_motion* at, double* wrenches) { ...; return 1; }
     static const struct mbd_force forces[] = {{.name = "pull", .evaluate = pull}};
     static const struct mbd_plugin plugin = {MBD_PLUGIN_VERSION, 1, forces};
     const struct mbd_plugin* mbd_get_plugin(void) { return &plugin; }

   and a model asks for it by <extension force="pull" at="arm.end" values="stiffness=40"/>. What is wrong with a plug-in (another
   version, no such function, an exception, numbers that are none) is an error that names its file, and nothing is run.

   SI units throughout; all arrays belong to the caller, and are valid during the call. */
#ifndef MBD_PLUGIN_H
#define MBD_PLUGIN_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of this interface. A plug-in of another version is refused. */
#define MBD_PLUGIN_VERSION 1

/* A number that the model gives: values="stiffness=40 length=2*L" of its <extension>. */
struct mbd_value {
  const char* name;
  double value; /* SI units */
};

/* The motion of one node that a force acts on. x_inertial = position + rotation x_place. */
struct mbd_place {
  double position[3]; /* inertial axes [m] */
  double rotation[9]; /* row by row; its columns are the axes of the section or body there, along inertial ones */
  double velocity[6]; /* [v; w], along the axes of the place [m/s, rad/s]; in statics zero */
};

/* Places in the order of the extension's `at`; a beam there gives all of its nodes, along its reference line. */
struct mbd_motion {
  double t; /* [s] */
  size_t count;
  const struct mbd_place* places;
};

/* Functions that return an int: 1 when they have done it, 0 if not. `self` is what make() has returned, or null. They may be
   called from several threads at once where a program steps several states at once; they must not keep what they are called with: the same
   motion gives the same force, also after a step that was taken back. */
struct mbd_force {
  const char* name; /* what the `force` of an <extension> calls it */

  /* Optional. One of these forces with these values; null with what is wrong in `message` (at most size bytes, with
     a zero at its end): the model is refused with it. */
  void* (*make)(const struct mbd_value* values, size_t count, char* message, size_t size);

  /* Force and moment on each place, along its axes [N, N.m]: 6 count numbers, zero when it is called. 0: not at this motion (out
     of the range of a table, say); the step is then tried shorter. Loads of a <static> are multiplied by the load factor, these
     too. */
  int (*evaluate)(void* self, const struct mbd_motion* at, double* wrenches);

  /* Optional. Derivatives of wrenches by increments du of all places, place := place exp(du), du along the axes of the
     place [m, rad], at fixed velocities; and by velocities. Each 6 count times 6 count numbers, row by row (a row is one component of
     the wrenches), zero when it is called. Without it, or where it returns 0, differences are taken: 24 count evaluations a tangent. */
  int (*derivatives)(void* self, const struct mbd_motion* at, double* by_motion, double* by_velocity);

  /* Optional, of a force that is minus the gradient of a potential [J]: it is counted with strain energy, not as work of loads. */
  int (*energy)(void* self, const struct mbd_motion* at, double* energy);

  /* Optional. Of what make() has returned. */
  void (*destroy)(void* self);
};

struct mbd_plugin {
  int version; /* MBD_PLUGIN_VERSION; nothing else is read where it differs */
  size_t count;
  const struct mbd_force* forces; /* they live as long as the plug-in */
};

/* What a plug-in defines. */
const struct mbd_plugin* mbd_get_plugin(void);

#ifdef __cplusplus
}
#endif

#endif
