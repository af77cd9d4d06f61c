// A worker of Jolt's pool, which in node does not start by itself.
import startWorker from 'jolt-physics/wasm-multithread';

startWorker();
