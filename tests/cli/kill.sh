# kill.sh FOLDER "COUNT…" COMMAND…: kills the command each time when FOLDER's shards have COUNT results.
for count in $2; do
  "${@:3}" > said 2>&1 &
  until [ "$(cat $1/shards/* 2> none | grep -c asked)" -ge $count ] || ! kill -0 $! 2> none; do sleep 0.001; done
  kill -9 $!
  wait $!
  echo $?
done
