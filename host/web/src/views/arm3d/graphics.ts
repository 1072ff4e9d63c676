// Lets the page do all else while a view is made and while the graphics processor works: neither may hold the page up.

const LOOK_EVERY_MS = 10;

/** Ends this task of the page; what waits comes first. */
export function pause(ms = 0): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** Waits until the graphics processor has done all that it was told, or is lost. */
export async function finished(context: WebGL2RenderingContext): Promise<void> {
  const fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!fence) return;
  context.flush();
  while (!context.isContextLost() && context.getSyncParameter(fence, context.SYNC_STATUS) === context.UNSIGNALED) {
    await pause(LOOK_EVERY_MS);
  }
  context.deleteSync(fence);
}
