// Starts the page: of a recording, or of a run that goes on.
import {Recording} from './data.js';
import {LivePlayer} from './live.js';
import {Player} from './player.js';

/** @param {ArrayBuffer} data  @param {?ArrayBuffer} second shown beside it  @returns the player, for scripts and tests */
export async function start(data, second) {
  const recording = new Recording(data);
  return recording.live ? new LivePlayer(data) : new Player(recording, second && new Recording(second));
}
