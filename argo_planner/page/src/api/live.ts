/** A connection over which the service tells what happens. It comes back by itself. */

const SOONEST_MS = 250;
const LATEST_MS = 4_000;
const GONE = 4404;

export interface Telling<Message> {
  /** Path and query of the socket, asked for at each attempt, so that it can say what is known. */
  address: () => string;
  heard: (message: Message) => void;
  /** Whether the connection stands. */
  changed: (connected: boolean) => void;
  /** What was followed is not there any more; the connection does not come back. */
  gone?: () => void;
}

export class LiveConnection<Message> {
  private socket: WebSocket | null = null;
  private waiting: ReturnType<typeof setTimeout> | undefined;
  private pause = SOONEST_MS;
  private closed = false;

  constructor(private readonly telling: Telling<Message>) {
    this.connect();
    addEventListener("online", this.retry);
  }

  send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  close(): void {
    this.closed = true;
    removeEventListener("online", this.retry);
    clearTimeout(this.waiting);
    this.socket?.close();
  }

  private readonly retry = (): void => {
    if (this.socket !== null || this.closed) return;
    clearTimeout(this.waiting);
    this.connect();
  };

  private connect(): void {
    const url = new URL(this.telling.address(), location.href);
    url.protocol = url.protocol.replace("http", "ws");
    const socket = new WebSocket(url);
    this.socket = socket;
    socket.onopen = () => {
      this.pause = SOONEST_MS;
      this.telling.changed(true);
    };
    socket.onmessage = (event: MessageEvent<string>) => {
      this.telling.heard(JSON.parse(event.data) as Message);
    };
    socket.onclose = (event) => {
      if (this.socket !== socket) return;
      this.socket = null;
      if (this.closed) return;
      this.telling.changed(false);
      if (event.code === GONE) {
        this.closed = true;
        this.telling.gone?.();
        return;
      }
      this.waiting = setTimeout(this.retry, this.pause * (0.75 + Math.random() / 2));
      this.pause = Math.min(2 * this.pause, LATEST_MS);
    };
  }
}
