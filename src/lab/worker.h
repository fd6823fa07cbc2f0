// SPDX-License-Identifier: Apache-2.0
// A worker process: one interactive session for one page. It reads the commands of the page from the server, and writes
// events and images. An error of the driver, a crash or an endless shader ends only this process
// (session_supervisor.h restarts it).
#ifndef QUINTET_LAB_WORKER_H
#define QUINTET_LAB_WORKER_H

namespace quintet::lab {

// Works until the server closes the socket. Returns the exit status of the process.
int runWorker(int socket);

}  // namespace quintet::lab
#endif
